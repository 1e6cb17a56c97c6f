#include "diagnosis/something_else.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include "diagnosis/leftovers.h"
#include "diagnosis/structure_refinement.h"

namespace abbe::diagnosis {
namespace {

constexpr const char* kId = "something-else";

// Along an axis as its positioning error is, seen from another carriage or at the ball: "EXZ" over
// x, "ball_x" over x.
bool IsAlong(const std::string& channel, const std::string& variable) {
  if (variable.size() != 1) return false;
  if (channel == "ball_" + variable) return true;
  return channel.size() == 3 && channel[0] == 'E' && channel[1] == std::toupper(variable[0]);
}

// A wave of an axis along itself, of a pivot over its own angle, of a sensor over that of the
// shaft: screws, encoders and targets make those.
bool IsInCatalogue(const Structure& structure) {
  return structure.form == Structure::Form::kLine &&
         (structure.IsOfItself() || structure.variable == "shaft" ||
          IsAlong(structure.channel.object, structure.variable));
}

}  // namespace

Candidate SomethingElse::CandidateOf(const Found& found) {
  const Structure& structure = found.structure;
  auto cause = std::make_unique<simulation::Cause>();
  // Each is one of its kind: two structures of one channel are two candidates.
  cause->id = std::string(kId) + std::to_string(causes_.size()) + " in " + structure.variable;
  cause->plausible = Eigen::VectorXd::Ones(structure.columns());
  cause->columns = [structure](const simulation::Trace& trace, const simulation::Object&,
                               const Eigen::VectorXd&) { return structure.ColumnsOf(trace); };
  cause->amount = simulation::Amount::kRandomField;
  cause->fixed_shapes = true;
  causes_.push_back(std::move(cause));
  return {causes_.back().get(), simulation::Object(structure.channel.object),
          Eigen::Vector2d(found.drawn.sd, 0.0)};
}

std::optional<Found> MostProbable(const Fit& fit, const std::vector<Found>& found) {
  std::optional<Found> most;
  for (const auto form : {Structure::Form::kSmooth, Structure::Form::kLine,
                          Structure::Form::kInterval, Structure::Form::kProduct}) {
    const Found* best = nullptr;
    for (const Found& each : found) {
      if (each.structure.form != form || IsInCatalogue(each.structure)) continue;
      if (!best || each.drawn.log_evidence > best->drawn.log_evidence) best = &each;
    }
    if (!best || best->drawn.log_evidence <= 0.0) continue;
    Found refined = Refined(fit, *best);
    if (!most || refined.drawn.log_evidence > most->drawn.log_evidence) most = std::move(refined);
  }
  return most;
}

void AddThoseAlike(const Fit& fit, const std::vector<Found>& found, Found& most) {
  constexpr double kWorthRefining = 20.0;  // in log evidence
  constexpr std::size_t kMost = 8;
  std::vector<const Found*> near;  // the best of each other variable in each channel
  const auto is_own = [&](const Found& each) {
    return each.structure.variable == most.structure.variable &&
           each.structure.channel.object == most.structure.channel.object;
  };
  for (const Found& each : found) {
    if (is_own(each) || IsInCatalogue(each.structure) ||
        each.drawn.log_evidence < most.drawn.log_evidence - kWorthRefining) {
      continue;
    }
    near.push_back(&each);
  }
  std::ranges::sort(near, std::greater(),
                    [](const Found* each) { return each->drawn.log_evidence; });
  near.resize(std::min(near.size(), kMost));
  for (const Found* each : near) {
    const Found refined = Refined(fit, *each);
    if (refined.drawn.log_evidence < most.drawn.log_evidence - kAsGood) continue;
    AddAlike(refined.structure, most);
  }
}

double LogPosterior(const Found& found, std::size_t questions) {
  return found.drawn.log_evidence + std::log(kElse / questions);
}

}  // namespace abbe::diagnosis
