// A stranger's program: a play of 8 um in X of a virtual machine, found in a run of a grid encoder
// to and fro.    explain MACHINE.toml
#include <cstdio>

#include "diagnosis/diagnose.h"
#include "rig/campaign.h"
#include "rig/record_course.h"

int main(int, char** argv) {
  const auto document = abbe::settings::Document::Read(argv[1]);
  const auto machine = abbe::rig::ReadCampaignMachine(document.Root());
  const abbe::rig::HiddenEffects play{
      abbe::rig::ParseHidden("backlash:object=X:width_um=8", 3, machine.sensors)};
  const abbe::rig::LinkageRig rig(
      abbe::rig::World(machine.rig, 3, play),
      abbe::rig::Linkage(abbe::rig::ReadLinkage(document.Root()), 3, play));
  abbe::rig::Course course{{0.002, 0.03, 0.03}, {}};
  for (int i = 1; i <= 80; ++i) {  // four times there and back, in ten steps
    const int step = i % 20 <= 10 ? i % 20 : 20 - i % 20;
    course.moves.push_back({{{0.002 + 0.0056 * step, 0.03, 0.03}},
                            0.02,
                            1.0,
                            1 + (i - 1) / 20,
                            (i - 1) % 20 < 10 ? 1 : -1});
  }
  abbe::diagnosis::Campaign campaign({abbe::machine::ReadMachine(document.Root()), {}, {}, {}, {}});
  campaign.Add(rig.Record(course, {.kind = "reference", .rate = 10.0}));
  const auto diagnosis = abbe::diagnosis::Diagnose(campaign);
  for (const auto& finding : diagnosis.findings) {
    std::printf("%s, %.2f um\n", finding.score.candidate.Name().c_str(),
                1e6 * finding.score.coefficients[0]);
  }
  return diagnosis.findings.size() == 1 &&
                 diagnosis.findings[0].score.candidate.Name() == "backlash:X"
             ? 0
             : 1;
}
