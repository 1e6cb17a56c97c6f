#include "apps/evaluate_plate.h"

#include <utility>

#include "failure/progress.h"

namespace abbe::apps {

PlateResult EvaluatePlate(const machine::Machine& machine,
                          const std::vector<simulation::PlateSetup>& measured,
                          const PlateOptions& options) {
  std::vector<fusion::WrongHole> wrong = fusion::FindWrongHoles(machine, measured);
  const auto setups = fusion::WithoutHoles(measured, wrong);
  const auto runs_on = [&](const machine::VolumetricModel& model) {
    std::vector<simulation::SimulatedRun> runs;
    runs.reserve(setups.size());
    for (const auto& setup : setups) {
      runs.push_back(simulation::SimulatePlate(model, machine.reference, setup));
    }
    return runs;
  };
  Steps steps(1);
  PlateResult result{
      fusion::Fuse(machine, runs_on(fusion::UnknownMachine(machine)),
                   {.choose_smoothness = !options.fixed_smoothness, .runs_on = runs_on}),
      {},
      {},
      {},
      std::move(wrong)};
  const fusion::FuseReport& fused = result.fused;
  result.diagonals = fusion::SquarenessByDiagonals(fused, machine.reference, setups);
  if (options.holdout > 0) {
    steps.Begin("holes held out");
    result.interpolators =
        fusion::CompareInterpolators(machine, fused.chosen_smoothness, setups, options.holdout);
  }
  if (options.specimen) result.specimen = fusion::CheckSpecimen(fused.map, *options.specimen);
  return result;
}

}  // namespace abbe::apps
