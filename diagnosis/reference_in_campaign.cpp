#include "diagnosis/reference_in_campaign.h"

#include <fmt/format.h>

#include "failure/failure.h"
#include "simulation/points/reference_noise.h"
#include "simulation/points/reference_simulation.h"
#include "simulation/points/reference_trace.h"

namespace abbe::diagnosis {
namespace {

using simulation::ReferenceRun;

constexpr Eigen::Index kMostReferenceRows = 4000;  // of one run: more tell no more of causes

bool StatesNoise(const ReferenceRun& run) { return run.sd.minCoeff() > 0.0; }

std::string NoiseText(const ReferenceRun& run, const simulation::RepeatNoise& noise) {
  std::string text =
      fmt::format("{}: noise of the reference by how well its readings repeat:", run.points.name);
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    if (!run.shown[static_cast<std::size_t>(axis)]) continue;
    text += fmt::format(" ref_{} {:.3g} um", "xyz"[axis], 1e6 * noise.sd[axis]);
  }
  return text + fmt::format(", {} degrees of freedom", noise.freedom);
}

// Of a run that states none.
Eigen::Vector3d NoiseOf(const ReferenceRun& run, Setup& setup, std::vector<std::string>& notes) {
  const auto known = setup.reference_noise.find(run.points.name);
  if (known != setup.reference_noise.end()) return known->second;
  if (const auto noise = simulation::NoiseOfRepeats(run)) {
    notes.push_back(NoiseText(run, *noise));
    return setup.reference_noise.emplace(run.points.name, noise->sd).first->second;
  }
  if (setup.linkage) return Eigen::Vector3d::Constant(setup.linkage->noise.reference);
  throw InputError(fmt::format(
      "{}: the noise of the reference is not known: it states none, and too few readings repeat "
      "to tell; state u_reference_um in its header",
      run.points.name));
}

}  // namespace

DiagnosedRun MakeReferenceRun(const recording::Recording& recording, Setup& setup,
                              const machine::VolumetricModel& model,
                              std::vector<std::string>& notes) {
  const machine::Machine& mill = setup.machine;
  ReferenceRun run = simulation::Thinned(simulation::MeansOfStays(simulation::ReadReferenceRun(
                                             simulation::WithAllAxes(recording, mill.travels))),
                                         kMostReferenceRows);
  if (!StatesNoise(run)) simulation::SetNoise(NoiseOf(run, setup, notes), run);
  return {simulation::SimulateReference(model, mill.reference, run),
          simulation::TraceOf(recording, run)};
}

}  // namespace abbe::diagnosis
