#include "simulation/learned/learned_term.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "simulation/stage_channel.h"
#include "simulation/variables.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;

StageChannel ChannelOfTerm(const LearnedTerm& term) { return ChannelNamed(term.object).value(); }

bool IsOfErrorMotion(const StageChannel& channel) { return channel.stage < kToolStage; }

// Whether one of the 21 errors could be it: an error motion of an axis by its own position.
bool IsInMap(const LearnedTerm& term) {
  const StageChannel channel = ChannelOfTerm(term);
  if (!IsOfErrorMotion(channel)) return false;
  const std::string own(1, "xyz"[channel.stage / machine::kMotions]);
  const auto& terms = term.expression.terms;
  return std::ranges::all_of(terms, [&](const Product& product) {
    return std::ranges::all_of(product, [&](const Atom& atom) {
      return atom.variable == own && atom.form != Atom::Form::kSign &&
             atom.form != Atom::Form::kPlay && atom.form != Atom::Form::kLag;
    });
  });
}

Follows WhatItFollows(const LearnedTerm& term) {
  Follows follows = Follows::kPath;
  for (const std::string& variable : term.expression.Variables()) {
    if (variable.starts_with("time")) return Follows::kTime;
    const bool is_recorded = variable.find("temp_") != std::string::npos ||
                             variable.starts_with("column ") || variable.starts_with("gap of ");
    if (is_recorded) follows = Follows::kTemperature;
  }
  return follows;
}

// Within what was covered.
VariableValues ValuesWithin(const std::vector<Covered>& covered) {
  return [covered](const std::string& variable, const Trace& trace) -> Eigen::RowVectorXd {
    Eigen::RowVectorXd values = ValuesInUnit(variable, trace);
    const auto range = std::ranges::find(covered, variable, &Covered::variable);
    if (range == covered.end()) return values;
    return values.cwiseMax(range->from).cwiseMin(range->to);
  };
}

std::vector<CauseKey> KeysOfTerm(const LearnedTerm& term) {
  const StageChannel channel = ChannelOfTerm(term);
  std::vector<CauseKey> keys;
  const Index count = term.expression.columns();
  for (Index i = 0; i < count; ++i) {
    const std::string number = count == 1 ? "" : fmt::format("_{}", i + 1);
    keys.push_back({fmt::format("coefficient{}_{}", number, channel.unit.name), channel.unit.si});
  }
  return keys;
}

}  // namespace

std::string StageName(const std::string& object) {
  const Index stage = ChannelNamed(object).value().stage;
  if (stage >= kEncoderStage) return "encoder";
  if (stage >= kReadingStage) return "reading";
  return stage >= kTipStage ? "tip" : "motion";
}

std::shared_ptr<const LearnedCause> LearnedCause::Of(LearnedTerm term) {
  constexpr double kWide = 10.0;  // the data say how large it is
  return std::shared_ptr<const LearnedCause>(new LearnedCause(std::move(term), kWide));
}

std::shared_ptr<const LearnedCause> LearnedCause::CarriedOn(LearnedTerm term) {
  if (term.words.empty()) term.words = "a term that was learned on another machine";
  return std::shared_ptr<const LearnedCause>(new LearnedCause(std::move(term), 1.0));
}

LearnedCause::LearnedCause(LearnedTerm term, double times) : term_(std::move(term)) {
  constexpr double kPlausible = 10e-6;  // m or rad
  const StageChannel channel = ChannelOfTerm(term_);
  cause_.id = term_.name.empty() ? term_.expression.Text() : term_.name;
  cause_.words.what = term_.words;
  cause_.words.shows = fmt::format("{} follows {}", term_.object, term_.expression.Text());
  cause_.keys = KeysOfTerm(term_);
  // As large as it was found, where it was: a coefficient has the unit of its summand.
  cause_.plausible = Eigen::VectorXd::Constant(term_.expression.columns(), kPlausible);
  const Index known = std::min(cause_.plausible.size(), term_.coefficients.size());
  for (Index i = 0; i < known; ++i) {
    const double size = std::abs(term_.coefficients[i]);
    if (size > 0.0) cause_.plausible[i] = times * size;
  }
  cause_.objects = [object = Object(term_.object)](const Scene& scene) -> std::vector<Object> {
    const auto channels = ChannelsOf(scene);
    const bool has =
        std::ranges::find(channels, object.name(), &StageChannel::object) != channels.end();
    return has ? std::vector<Object>{object} : std::vector<Object>{};
  };
  cause_.columns = [channel, expression = term_.expression, values = ValuesWithin(term_.covered)](
                       const Trace& trace, const Object&,
                       const Eigen::VectorXd&) -> std::vector<Disturbance> {
    if (!channel.Feels(trace)) return {};
    const Eigen::MatrixXd functions = expression.Of(trace, values);
    std::vector<Disturbance> columns;
    columns.reserve(functions.rows());
    for (const auto& function : functions.rowwise()) {
      columns.push_back(InStage(trace, channel.stage, function));
    }
    return columns;
  };
  cause_.fixed_shapes = true;
  cause_.follows = WhatItFollows(term_);
  cause_.in_map = IsInMap(term_);
  if (IsOfErrorMotion(channel) && !cause_.in_map) cause_.seat = CorrectedBy::kMotion;
}

}  // namespace abbe::simulation
