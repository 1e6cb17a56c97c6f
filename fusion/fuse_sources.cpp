#include "fusion/fuse_sources.h"

#include <utility>

#include "fusion/machine_prior.h"
#include "simulation/kinds.h"

namespace abbe::fusion {

FuseReport FuseSources(const std::vector<simulation::RunSource>& sources,
                       const simulation::Instruments& instruments, FuseOptions options,
                       const AsTaken& as_taken) {
  const auto runs_on = [&](const machine::VolumetricModel& model) {
    std::vector<simulation::SimulatedRun> runs;
    for (const simulation::RunSource& source : sources) {
      for (auto& run :
           simulation::SimulateForMap(as_taken ? as_taken(source) : source, model, instruments)) {
        runs.push_back(std::move(run));
      }
    }
    return runs;
  };
  const machine::Machine& machine = instruments.machine;
  if (options.knots) {
    return Fuse(machine, runs_on(UnknownMachine(machine, *options.knots)), options);
  }
  options.runs_on = runs_on;
  return Fuse(machine, runs_on(UnknownMachine(machine)), options);
}

}  // namespace abbe::fusion
