#include "diagnosis/shaft_in_campaign.h"

#include <fmt/format.h>

#include "failure/failure.h"
#include "simulation/shaft/shaft_run.h"
#include "simulation/shaft/shaft_simulation.h"

namespace abbe::diagnosis {
namespace {

using simulation::RimRepeats;
using simulation::ShaftRun;

constexpr Eigen::Index kMostShaftRows = 6000;  // of one run: more tell no more of causes
constexpr double kRounding = 1e-12;            // m

void TellSense(const ShaftRun& run, std::vector<std::string>& notes) {
  notes.push_back(fmt::format(
      "{}: by what the sensors see, the angle of the shaft grows {} the count of sensor_deg; where "
      "that is wrong, state shaft_sense = {} in the header",
      run.name, run.sense > 0 ? "with" : "against", -run.sense));
}

void TellNoise(const ShaftRun& run, const RimRepeats& repeats, std::vector<std::string>& notes) {
  std::string text =
      fmt::format("{}: noise by how well {:.1f} turns repeat:", run.name, repeats.turns);
  for (Eigen::Index i = 0; i < repeats.sd.size(); ++i) {
    text += fmt::format(" sensor_{} {:.3g} um (counts as {:.3g} um, neighbours share it)", i + 1,
                        1e6 * repeats.scatter[i], 1e6 * repeats.sd[i]);
  }
  notes.push_back(text);
}

Eigen::VectorXd NoiseOf(const ShaftRun& run, const RimRepeats& repeats) {
  if (repeats.sd.size() == 0) {
    throw InputError(fmt::format(
        "{}: the noise of the sensors is not known: {:.2f} turns are too few to see how well they "
        "repeat; record {:.0f} or more, or state u_gap_um in the header",
        run.name, repeats.turns, simulation::kLeastTurns));
  }
  if (repeats.sd.minCoeff() > kRounding) return repeats.sd;
  throw InputError(fmt::format(
      "{}: a sensor repeats to its last digit in every turn; state the noise of a reading as "
      "u_gap_um in the header",
      run.name));
}

}  // namespace

DiagnosedRun MakeShaftRun(const recording::Recording& recording, Setup& setup,
                          std::vector<std::string>& notes) {
  ShaftRun run = simulation::ReadShaftRun(recording);
  const auto [known, is_new] = setup.shaft_repeats.try_emplace(run.name);
  RimRepeats& repeats = known->second;
  if (is_new) repeats = simulation::RepeatsOf(run);
  if (run.sense == 0) {
    simulation::SetSense(repeats.sense, run);
    if (is_new && run.rim.sensors > 1) TellSense(run, notes);
  }
  if (!(run.sd.minCoeff() > 0.0)) {
    run.sd = NoiseOf(run, repeats);
    if (is_new) TellNoise(run, repeats, notes);
  }
  const ShaftRun thinned = simulation::Thinned(run, kMostShaftRows);
  return {simulation::SimulateShaft(thinned), simulation::TraceOf(recording, thinned)};
}

}  // namespace abbe::diagnosis
