// A stranger's program: a hole plate on a virtual machine, its error map, and a corrected position,
// which has to come nearer to where it was wanted.    measure MACHINE.toml
#include <cstdio>

#include "compensation/corrector.h"
#include "fusion/fuse.h"
#include "rig/record_plate.h"
#include "simulation/points/plate_simulation.h"

int main(int, char** argv) {
  const auto document = abbe::settings::Document::Read(argv[1]);
  const auto mill = abbe::machine::ReadMachine(document.Root());
  const abbe::rig::World world(abbe::rig::ReadRigSettings(document.Root()), 7);
  const auto model = abbe::fusion::UnknownMachine(mill);
  std::vector<abbe::simulation::SimulatedRun> runs;
  for (const auto& setup : abbe::simulation::ReadPlate(abbe::rig::RecordPlate(world, {}))) {
    runs.push_back(abbe::simulation::SimulatePlate(model, mill.reference, setup));
  }
  const auto report = abbe::fusion::Fuse(mill, runs, {.choose_smoothness = false});
  const Eigen::Vector3d wanted(0.05, 0.01, 0.04), zero = Eigen::Vector3d::Zero();
  const auto tool_in_work = [&](const Eigen::Vector3d& axes) -> Eigen::Vector3d {
    const auto table = world.PoseOfTarget(axes);
    return table.rotation.transpose() * (world.PoseOfHead(axes) * zero - table.translation);
  };
  const Eigen::Vector3d perfect(-wanted.x(), -wanted.y(), wanted.z());
  const auto command = abbe::compensation::Corrector(report.map, zero).Command(wanted);
  const double before = (tool_in_work(wanted) - perfect).norm();
  const double after = (tool_in_work(command) - perfect).norm();
  std::printf("off by %.2f um, corrected by %.2f um\n", 1e6 * before, 1e6 * after);
  return after < before / 2 ? 0 : 1;
}
