#include "fusion/fuse_sources.h"

#include <iterator>
#include <utility>

#include "estimation/in_parallel.h"
#include "fusion/machine_prior.h"
#include "simulation/kinds.h"

namespace abbe::fusion {

FuseReport FuseSources(const std::vector<simulation::RunSource>& sources,
                       const simulation::Instruments& instruments, FuseOptions options,
                       const AsTaken& as_taken) {
  const auto runs_on = [&](const machine::VolumetricModel& model) {
    std::vector<std::vector<simulation::SimulatedRun>> of_sources(sources.size());
    const auto simulate = [&](std::size_t s) {
      of_sources[s] = simulation::SimulateForMap(as_taken ? as_taken(sources[s]) : sources[s],
                                                 model, instruments);
    };
    if (as_taken) {
      for (std::size_t s = 0; s < sources.size(); ++s) simulate(s);
    } else {
      estimation::InParallel(sources.size(), simulate);
    }
    std::vector<simulation::SimulatedRun> runs;
    for (auto& of_one : of_sources)
      std::move(of_one.begin(), of_one.end(), std::back_inserter(runs));
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
