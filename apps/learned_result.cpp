#include "apps/learned_result.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "apps/diagnosis_result.h"
#include "learned/words.h"
#include "simulation/stage_channel.h"
#include "standards/coverage.h"

namespace abbe::apps {
namespace {

using learned::Learned;
using nlohmann::ordered_json;

ordered_json TermJson(const Learned& learned) {
  const simulation::LearnedTerm& term = learned.term();
  const auto unit = simulation::ChannelNamed(term.object).value().unit;
  const auto& why = term.certificate;
  ordered_json json{{"object", term.object},
                    {"stage", simulation::StageName(term.object)},
                    {"expression", term.expression.Text()},
                    {"variables", term.expression.Variables()},
                    {"smooth", learned.is_smooth},
                    {"found", learned.IsFound()},
                    {"doubts", learned.doubts},
                    {"words", learned::InWords(term)},
                    {"suggestion", learned::SuggestionFor(term)},
                    {"unit", unit.name},
                    {"amplitude", learned.amplitude / unit.si}};
  for (Eigen::Index i = 0; i < term.coefficients.size(); ++i) {
    json["coefficients"].push_back(term.coefficients[i] / unit.si);
    json["u95"].push_back(standards::kCoverage * std::sqrt(term.covariance(i, i)) / unit.si);
  }
  json["u95_of_numbers"] = term.u95_of_numbers;
  for (const auto& covered : term.covered) {
    json["covered"].push_back(
        {{"variable", covered.variable}, {"from", covered.from}, {"to", covered.to}});
  }
  if (learned.is_certified)
    json["certificate"] = {{"by_chance", why.by_chance},
                           {"heldout_rms_before", why.heldout_before},
                           {"heldout_rms_after", why.heldout_after},
                           {"regime", why.regime},
                           {"imitated", why.imitated},
                           {"nearest", why.nearest},
                           {"cosine", why.cosine}};
  json["group"] = learned.group;
  json["alike"] = learned.alike;
  json["rivals"] = learned.rivals;
  if (learned.curve.at.size() > 0) json["curve"] = CurveJson(learned.curve);
  return json;
}

std::string RegimeText(const std::string& regime) {
  if (regime == simulation::kHolds) return "the outer fifths of the range ask for the same size";
  if (regime == simulation::kFails) {
    return "the outer fifths of the range ask for another size: valid between what was measured";
  }
  return "the outer fifths of the range cannot tell: valid between what was measured";
}

std::string TermText(const Learned& learned) {
  const simulation::LearnedTerm& term = learned.term();
  const auto& why = term.certificate;
  const auto unit = simulation::ChannelNamed(term.object).value().unit;
  std::string text =
      fmt::format("\n{}: {}\n  expression   {} in {}, {:.3g} {} rms\n",
                  learned.IsFound() ? "LEARNED" : "not certain", learned::InWords(term),
                  term.expression.Text(), term.object, learned.amplitude / unit.si, unit.name);
  if (!learned.alike.empty()) {
    text += fmt::format("  or at        {}, which these runs show alike\n",
                        fmt::join(learned.alike, ", "));
  }
  for (const std::string& rival : learned.rivals) {
    text += fmt::format("  or           {}, nearly as probable\n", rival);
  }
  if (!learned.is_certified) {
    for (const std::string& doubt : learned.doubts) {
      text += fmt::format("  not certain: {}\n", doubt);
    }
    return text;
  }
  text += fmt::format("  in noise     as much with a chance of {:.1g}, the whole grammar asked\n",
                      why.by_chance);
  if (why.heldout_before > 0.0) {
    text +=
        fmt::format("  held out     rms {:.3f} of the stated noise without it, {:.3f} with it\n",
                    why.heldout_before, why.heldout_after);
  }
  if (!learned.is_smooth) text += fmt::format("  elsewhere    {}\n", RegimeText(why.regime));
  text += fmt::format("  imitated     {:.0f} % of its effect by parameters of the simulation",
                      100.0 * why.imitated);
  if (!why.nearest.empty()) {
    text += fmt::format("; the nearest cause is {}, cosine {:.2f}", why.nearest, why.cosine);
  }
  text += "\n";
  if (!learned.group.empty()) {
    text += fmt::format("  or one of    {}\n", fmt::join(learned.group, ", "));
  }
  if (const std::string suggestion = learned::SuggestionFor(term); !suggestion.empty()) {
    text += fmt::format("  suggestion   such things are made by {}\n", suggestion);
  }
  for (const std::string& doubt : learned.doubts) text += fmt::format("  not certain: {}\n", doubt);
  return text;
}

}  // namespace

void AddLearned(const learned::Learning& learning, ordered_json& result) {
  if (learning.terms.empty()) return;
  result["learned"] = ordered_json::array();
  for (const Learned& learned : learning.terms) result["learned"].push_back(TermJson(learned));
  result["left_before_learning"] = ordered_json::array();
  for (const auto& leftover : learning.before) {
    result["left_before_learning"].push_back(LeftoverJson(leftover));
  }
  result["chi2_per_row_learned"] = learning.chi_after;
}

std::string LearnedText(const learned::Learning& learning) {
  if (learning.terms.empty()) return "";
  std::string text = fmt::format(
      "\nLearned beside the causes: chi-square per row {:.3f} without, {:.3f} with it\n",
      learning.chi_before, learning.chi_after);
  for (const Learned& learned : learning.terms) text += TermText(learned);
  return text;
}

}  // namespace abbe::apps
