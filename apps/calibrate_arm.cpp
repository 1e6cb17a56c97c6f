#include "apps/calibrate_arm.h"

#include <fmt/format.h>

#include <string>

#include "apps/arm_tables.h"
#include "apps/command.h"
#include "apps/instruments.h"
#include "apps/machine_recording.h"
#include "apps/result_file.h"
#include "failure/failure.h"
#include "fusion/arm_calibration.h"
#include "map/text_file.h"
#include "relm/linkage_text.h"
#include "simulation/arm/arm_run.h"
#include "simulation/kinds.h"

namespace abbe::apps {
namespace {

namespace fs = std::filesystem;
using fusion::ArmPoses;

class ArmCommand {
 public:
  explicit ArmCommand(const ArmArguments& arguments)
      : arguments_(arguments),
        instruments_(ReadInstruments(arguments.machine)),
        causes_(arguments.causes, instruments_, kForCalibrating) {
    if (!arguments.out.empty() && fs::exists(arguments.out) &&
        fs::equivalent(arguments.out, arguments.machine)) {
      throw InputError(fmt::format(
          "{}: is the machine file that is corrected; name another file for the corrected one",
          arguments.out.string()));
    }
    for (const fs::path& path : arguments.checks) {
      for (const fs::path& used : arguments.recordings) {
        if (!fs::exists(path) || !fs::exists(used) || !fs::equivalent(path, used)) continue;
        throw InputError(fmt::format(
            "{}: a test set takes no part in the calibration; give other poses", path.string()));
      }
    }
  }

  int Run() {
    const relm::LinkageSettings& settings =
        instruments_.LinkageFor(arguments_.recordings.front().string());
    const Sets all = Read(false);
    fusion::ArmCalibration found = fusion::CalibrateArm(settings, all.runs, all.tests);
    if (causes_.WidensU95()) {
      const Sets certain = Read(true);
      fusion::AddDoubt(fusion::CalibrateArm(settings, certain.runs, certain.tests),
                       causes_.unexplained(), found);
    }
    if (!arguments_.out.empty()) {
      WriteText(relm::WithGeometry(map::ReadWhole(arguments_.machine), found.written, found.u95,
                                   arguments_.machine.string()),
                arguments_.out);
    }
    if (!arguments_.json.empty()) {
      auto json = ArmCalibrationJson(found, instruments_.machine.name);
      if (causes_.Active()) json["causes_taken_out"] = causes_.Data();
      WriteResult(json, arguments_.json);
    }
    if (arguments_.quiet) return kDone;
    fmt::print("{}", ArmCalibrationTable(found));
    if (causes_.Active()) fmt::print("{}\n", causes_.Line());
    return kDone;
  }

 private:
  struct Sets {
    std::vector<ArmPoses> runs, tests;
  };

  Sets Read(bool certain) {
    Sets sets;
    std::vector<simulation::RunSource> sources;
    std::string first;  // the ball of the machine file
    const auto read = [&](const std::vector<fs::path>& paths, std::vector<ArmPoses>& poses) {
      for (const fs::path& path : paths) {
        const recording::Recording recording = ReadRecordingOf(instruments_.machine, path);
        if (!simulation::IsArm(recording)) {
          throw InputError(recording.name +
                           ": is no run of an arm: kind linkage, with ref_x_mm, ref_y_mm, ref_z_mm "
                           "and no x_mm, y_mm, z_mm; calibrate it apart");
        }
        const std::string ball = recording.HeaderText("mounting.ball").value_or("");
        if (sources.empty()) first = ball;
        sources.push_back(simulation::SourceOf(recording));
        poses.push_back({PosesOf(recording, ball == first ? "" : ball),
                         PosesOf(certain ? causes_.TakeCertain(recording) : causes_.Take(recording),
                                 ball == first ? "" : ball)});
      }
    };
    read(arguments_.recordings, sets.runs);
    read(arguments_.checks, sets.tests);
    simulation::RefuseStrangers(sources, instruments_);
    return sets;
  }

  simulation::LinkageRun PosesOf(const recording::Recording& recording,
                                 const std::string& ball) const {
    simulation::LinkageRun run =
        simulation::ReadArmRun(recording, instruments_.LinkageFor(recording.name));
    run.ball = ball;
    return run;
  }

  const ArmArguments& arguments_;
  simulation::Instruments instruments_;
  CauseCorrection causes_;
};

}  // namespace

int CalibrateArm(const ArmArguments& arguments) { return ArmCommand(arguments).Run(); }

}  // namespace abbe::apps
