// The table [[learned]] of an extended model.
#include <fmt/format.h>

#include <cmath>

#include "failure/failure.h"
#include "settings/toml_text.h"
#include "simulation/learned/learned_term.h"
#include "simulation/stage_channel.h"

namespace abbe::simulation {
namespace {

using Eigen::Index;
using settings::Quoted;
using settings::Table;

Expression ReadExpression(const Table& table) {
  try {
    return ParseExpression(table.Text("expression"));
  } catch (const InputError& error) {
    throw table.Error("expression", error.what());
  }
}

Certificate ReadCertificate(const Table& table) {
  Certificate certificate;
  const settings::NumberRule share{.fallback = 0.0, .at_least = 0.0, .at_most = 1.0};
  certificate.by_chance =
      table.Number("by_chance", {.fallback = 1.0, .at_least = 0.0, .at_most = 1.0});
  certificate.heldout_before = table.Number("heldout_rms_before", {.fallback = 0.0});
  certificate.heldout_after = table.Number("heldout_rms_after", {.fallback = 0.0});
  certificate.regime = table.Choice("regime", {kUntold, kHolds, kFails});
  certificate.imitated = table.Number("imitated", share);
  certificate.nearest = table.Text("nearest", "");
  certificate.cosine = table.Number("cosine", share);
  table.RefuseUnknown();
  return certificate;
}

}  // namespace

LearnedTerm ReadLearnedTerm(const Table& table) {
  LearnedTerm term;
  term.object = table.Text("object");
  const auto channel = ChannelNamed(term.object);
  if (!channel) {
    throw table.Error("object",
                      "is no axis, error motion (EYX), probe, sensor, pivot or ball_x, _y, _z");
  }
  const std::string stage = table.Text("stage", StageName(term.object));
  if (stage != StageName(term.object)) {
    throw table.Error("stage", fmt::format("of {} is \"{}\"", term.object, StageName(term.object)));
  }
  term.expression = ReadExpression(table);
  const Index count = term.expression.columns();
  const auto coefficients =
      table.Quantities("coefficients_" + channel->unit.name, static_cast<std::size_t>(count));
  term.coefficients = Eigen::Map<const Eigen::VectorXd>(coefficients.data(), count);
  if (table.Has("covariance")) {
    const auto numbers = table.Quantities("covariance", static_cast<std::size_t>(count * count));
    term.covariance = Eigen::Map<const Eigen::MatrixXd>(numbers.data(), count, count);
  }
  term.u95_of_numbers = table.Quantities("u95_of_numbers", 0, std::vector<double>{});
  for (const Table& covered : table.Children("covered")) {
    const double from = covered.Number("from");
    term.covered.push_back(
        {covered.Text("variable"), from, covered.Number("to", {.at_least = from})});
    covered.RefuseUnknown();
  }
  term.certificate = ReadCertificate(table.Child("certificate"));
  term.name = table.Text("name", "");
  term.words = table.Text("words", "");
  table.RefuseUnknown();
  return term;
}

std::string LearnedTermText(const LearnedTerm& term) {
  const StageChannel channel = ChannelNamed(term.object).value();
  std::string text = fmt::format(
      "\n# {}\n[[learned]]\nstage = {}\nobject = {}\nexpression = {}\ncoefficients_{} = {}\n",
      term.words.empty() ? "a term that no known cause makes" : term.words,
      Quoted(StageName(term.object)), Quoted(term.object), Quoted(term.expression.Text()),
      channel.unit.name, settings::Floats(Eigen::VectorXd(term.coefficients / channel.unit.si)));
  if (!term.name.empty()) text += fmt::format("name = {}\n", Quoted(term.name));
  if (!term.words.empty()) text += fmt::format("words = {}\n", Quoted(term.words));
  if (term.covariance.size() > 0) {
    text += fmt::format("covariance = {}\n",
                        settings::Floats(Eigen::VectorXd(term.covariance.reshaped())));
  }
  if (!term.u95_of_numbers.empty()) {
    text += fmt::format("u95_of_numbers = {}\n", settings::Floats(term.u95_of_numbers));
  }
  const Certificate& why = term.certificate;
  text += fmt::format(
      "\n[learned.certificate]\nby_chance = {}\nheldout_rms_before = {}\nheldout_rms_after = "
      "{}\nregime = {}\nimitated = {}\n",
      settings::Float(why.by_chance), settings::Float(why.heldout_before),
      settings::Float(why.heldout_after), Quoted(why.regime), settings::Float(why.imitated));
  if (!why.nearest.empty()) {
    text += fmt::format("nearest = {}\ncosine = {}\n", Quoted(why.nearest),
                        settings::Float(why.cosine));
  }
  for (const Covered& covered : term.covered) {
    text += fmt::format("\n[[learned.covered]]\nvariable = {}\nfrom = {}\nto = {}\n",
                        Quoted(covered.variable), settings::Float(covered.from),
                        settings::Float(covered.to));
  }
  return text;
}

}  // namespace abbe::simulation
