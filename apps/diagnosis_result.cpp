#include "apps/diagnosis_result.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <vector>

#include "apps/leftovers_text.h"
#include "diagnosis/found_model.h"
#include "recording/file_hash.h"
#include "settings/unit.h"
#include "simulation/variables.h"

namespace abbe::apps {
namespace {

using diagnosis::Candidate;
using diagnosis::Diagnosis;
using diagnosis::Finding;
using diagnosis::HeldOutGain;
using diagnosis::Leftover;
using diagnosis::Score;
using Eigen::Index;
using nlohmann::ordered_json;

constexpr std::size_t kEvidenceShown = 8;

struct NamedValue {
  std::string name;
  double value, u95;
};

// The parameters of a finding in their own units.
std::vector<NamedValue> ParametersOf(const Score& score) {
  const simulation::ModelledCause found = diagnosis::FoundCause(score);
  std::vector<NamedValue> values;
  for (std::size_t i = 0; i < found.cause->keys.size(); ++i) {
    const auto& key = found.cause->keys[i];
    values.push_back({key.name, found.values[i] / key.unit, found.u95[i] / key.unit});
  }
  return values;
}

// The frequency, period or order of a wave, the instant of an event, in the unit of its key.
NamedValue ShapeOf(const Score& score) {
  const simulation::Cause& cause = *score.candidate.cause;
  const simulation::CauseKey& key = cause.keys[cause.KeyOfShape().value()];
  return {key.name, score.candidate.shape[0] / key.unit, 0.0};
}

// All shapes that the runs show alike, by rising values.
std::vector<NamedValue> OneOf(const Finding& finding) {
  std::vector<NamedValue> values;
  for (const Score& score : finding.score.one_of) values.push_back(ShapeOf(score));
  std::ranges::sort(values, {}, &NamedValue::value);
  return values;
}

std::string OneOfText(const Finding& finding) {
  const std::vector<NamedValue> values = OneOf(finding);
  if (values.empty()) return "";
  std::vector<std::string> told;
  told.reserve(values.size());
  for (const NamedValue& each : values) told.push_back(fmt::format("{:.6g}", each.value));
  return fmt::format("  {:<28}one of these: {}\n", values.front().name, fmt::join(told, ", "));
}

// The channels of a cause that is there or not, and has no value.
std::vector<std::string> ChannelsOf(const Candidate& candidate) {
  if (!candidate.cause->IsBinary()) return {};
  std::vector<std::string> channels;
  std::istringstream name(candidate.object.name());
  for (std::string channel; std::getline(name, channel, '+');) channels.push_back(channel);
  return channels;
}

// Beside what no known cause explains nobody should mend a machine for a finding.
bool GivesAdvice(const Diagnosis& diagnosis) {
  return diagnosis.verdict != diagnosis::Verdict::kUnexplained;
}

// The gain by a finding; none for findings in single rows, or if nothing was held out.
std::optional<HeldOutGain::Without> WorthOf(std::size_t finding, const Diagnosis& diagnosis,
                                            const HeldOutGain& gain) {
  const auto is_modelled = [](const Finding& each) { return diagnosis::IsModelled(each); };
  const auto at = diagnosis.findings.begin() + finding;
  if (!is_modelled(*at)) return std::nullopt;
  const auto place = std::count_if(diagnosis.findings.begin(), at, is_modelled);
  if (place >= std::ssize(gain.without)) return std::nullopt;
  const auto& without = gain.without[place];
  return std::isfinite(without.held) ? std::optional(without) : std::nullopt;
}

ordered_json FindingJson(std::size_t which, const Diagnosis& diagnosis, const HeldOutGain& gain) {
  const Finding& finding = diagnosis.findings[which];
  const simulation::Object& object = finding.score.candidate.object;
  ordered_json json{
      {"cause", finding.score.candidate.cause->id}, {"object", object.part()},
      {"probability", finding.probability},         {"log_evidence", finding.score.log_evidence},
      {"something_else", finding.something_else},   {"doubts", finding.doubts}};
  for (const NamedValue& each : ParametersOf(finding.score)) {
    ordered_json parameter = KeyJson(each.name);
    parameter.update({{"value", each.value}, {"u95", each.u95}});
    json["parameters"].push_back(parameter);
  }
  for (const NamedValue& each : OneOf(finding)) {
    json["one_of"].push_back({{"name", each.name}, {"value", each.value}});
  }
  const auto& words = finding.score.candidate.cause->words;
  json["words"] = {{"what", words.what}, {"shows", words.shows}};
  if (GivesAdvice(diagnosis) && !words.check.empty()) {
    json["words"].update({{"check", words.check}, {"remedy", words.remedy}});
  }
  if (const auto without = WorthOf(which, diagnosis, gain)) {
    json["rms_before"] = without->seen;
    json["rms_after"] = gain.seen;
    json["heldout_rms_before"] = without->held;
    json["heldout_rms_after"] = gain.after;
    json["gain"] = 1.0 - gain.after / without->held;
  } else {
    json["rms_before"] = std::sqrt(diagnosis.chi_before);
    json["rms_after"] = std::sqrt(diagnosis.chi_after);
  }
  const diagnosis::Curve& curve = finding.curve;
  if (curve.at.size() > 0) json["curve"] = CurveJson(curve);
  if (const std::string sensor = object.sensor(); !sensor.empty()) {
    json["parameters"].push_back({{"name", "sensor"}, {"value", sensor}});
  }
  for (const std::string& channel : ChannelsOf(finding.score.candidate)) {
    json["parameters"].push_back({{"name", "channel"}, {"value", channel}});
  }
  return json;
}

std::string FindingText(std::size_t which, const Diagnosis& diagnosis, const HeldOutGain& gain) {
  const Finding& finding = diagnosis.findings[which];
  std::string text = fmt::format("\n{}, probability {:.3f}\n", NameOf(finding.score.candidate),
                                 finding.probability);
  for (const NamedValue& each : ParametersOf(finding.score)) {
    text += fmt::format("  {:<28}{:>12.4g} +- {:.2g}\n", each.name, each.value, each.u95);
  }
  text += OneOfText(finding);
  const auto& words = finding.score.candidate.cause->words;
  text += fmt::format("  what it is   {}\n  how it shows {}\n", words.what, words.shows);
  // What was learned has none.
  if (GivesAdvice(diagnosis) && !words.check.empty()) {
    text += fmt::format("  check        {}\n  what to do   {}\n", words.check, words.remedy);
  }
  if (const auto without = WorthOf(which, diagnosis, gain)) {
    text += fmt::format(
        "  gain         rms {:.3f} of the stated noise without it, {:.3f} with it; in held-out "
        "rows {:.3f} and {:.3f}\n",
        without->seen, gain.seen, without->held, gain.after);
  }
  for (const std::string& doubt : finding.doubts) {
    text += fmt::format("  not certain: {}\n", doubt);
  }
  if (finding.something_else > 0.0) {
    text += fmt::format("  or something that is in no catalogue, probability {:.3f}\n",
                        finding.something_else);
  }
  for (const auto& rival : finding.rivals) {
    text +=
        fmt::format("  or {}, probability {:.3f}\n", NameOf(rival.candidate), rival.probability);
  }
  if (finding.next_run) {
    text += fmt::format("  to separate them: {}; expected probability of the right one {:.3f}\n",
                        finding.next_run->text, finding.next_run->expected_probability);
  } else if (!finding.rivals.empty()) {
    text += "  no run known to abbe would separate them\n";
  }
  return text;
}

std::string FindingsText(const Diagnosis& diagnosis, const HeldOutGain& gain) {
  if (diagnosis.findings.empty()) return "";
  std::string text = GivesAdvice(diagnosis) ? "" : "\nWhat would explain part of it:\n";
  for (std::size_t i = 0; i < diagnosis.findings.size(); ++i) {
    text += FindingText(i, diagnosis, gain);
  }
  return text;
}

std::string EvidenceText(const Diagnosis& diagnosis) {
  std::string text = fmt::format("\n{:<44}{:>14}{:>22}\n", "candidates, alone", "log evidence",
                                 "would be seen at");
  std::vector<Score> scores = diagnosis.evidence;
  std::sort(scores.begin(), scores.end(),
            [](const Score& a, const Score& b) { return a.log_evidence > b.log_evidence; });
  for (std::size_t i = 0; i < std::min(kEvidenceShown, scores.size()); ++i) {
    text += fmt::format("{:<44}{:>14.1f}{:>19.1f} sd\n", NameOf(scores[i].candidate),
                        scores[i].log_evidence, scores[i].visible);
  }
  return text;
}

}  // namespace

std::string NameOf(const Candidate& candidate) {
  return candidate.cause->id + ":" + simulation::Title(candidate.object);
}

ordered_json CurveJson(const diagnosis::Curve& curve) {
  const auto listed = [](const Eigen::VectorXd& values, double unit) {
    std::vector<double> list(values.begin(), values.end());
    for (double& each : list) each /= unit;
    return list;
  };
  return {{"variable", fmt::format("{} in {}", curve.variable, curve.variable_unit.name)},
          {"unit", curve.unit.name},
          {"x", listed(curve.at, curve.variable_unit.si)},
          {"before", listed(curve.before, curve.unit.si)},
          {"after", listed(curve.after, curve.unit.si)}};
}

ordered_json LeftoverJson(const Leftover& leftover) {
  ordered_json left{{"variable", leftover.variable},
                    {"object", leftover.object},
                    {"amplitude", leftover.amplitude / leftover.unit.si},
                    {"unit", leftover.unit.name},
                    {"p_value", leftover.p_value}};
  for (const auto& other : leftover.one_of) {
    left["one_of"].push_back({{"variable", other.variable}, {"object", other.object}});
  }
  if (!leftover.IsOfAnInterval()) return left;
  const auto unit = simulation::UnitOf(leftover.variable);
  left["from"] = leftover.from / unit.si;
  left["to"] = leftover.to / unit.si;
  left["variable_unit"] = unit.name;
  return left;
}

ordered_json KeyJson(const std::string& name) {
  std::string quantity(settings::StemOf(name));
  std::replace(quantity.begin(), quantity.end(), '_', ' ');
  return {{"name", name}, {"quantity", quantity}, {"unit", settings::UnitOf(name).name}};
}

ordered_json DiagnosisJson(const Diagnosis& diagnosis, const HeldOutGain& gain) {
  ordered_json json{{"command", "diagnose"},
                    {"verdict", Name(diagnosis.verdict)},
                    {"cannot_show", diagnosis.cannot_show},
                    {"findings", ordered_json::array()},
                    {"rivals", ordered_json::array()},
                    {"unexplained", ordered_json::array()},
                    {"chi2_per_row_before", diagnosis.chi_before},
                    {"chi2_per_row_after", diagnosis.chi_after},
                    {"noise_floor", 1.0},
                    {"map_change_um", 1e6 * diagnosis.map_change}};
  for (std::size_t i = 0; i < diagnosis.findings.size(); ++i) {
    const Finding& finding = diagnosis.findings[i];
    json["findings"].push_back(FindingJson(i, diagnosis, gain));
    if (finding.rivals.empty()) continue;
    ordered_json rivals{{"causes", {finding.score.candidate.Name()}},
                        {"odds", {finding.probability}}};
    for (const auto& rival : finding.rivals) {
      rivals["causes"].push_back(rival.candidate.Name());
      rivals["odds"].push_back(rival.probability);
    }
    if (finding.next_run) {
      rivals["next_run"] = finding.next_run->text;
      rivals["expected_odds"] = finding.next_run->expected_probability;
    }
    json["rivals"].push_back(rivals);
  }
  if (gain.rows > 0) {
    json["heldout"] = {{"rows", gain.rows}, {"rms_before", gain.before}, {"rms_after", gain.after}};
  }
  if (gain.arm_poses > 0) {
    json["heldout_arm"] = {{"poses", gain.arm_poses},
                           {"rms_before_mm", 1e3 * gain.arm_before},
                           {"rms_after_mm", 1e3 * gain.arm_after}};
  }
  for (const Leftover& leftover : diagnosis.leftovers) {
    json["unexplained"].push_back(LeftoverJson(leftover));
  }
  for (const Score& score : diagnosis.evidence) {
    json["evidence"].push_back({{"cause", score.candidate.cause->id},
                                {"object", score.candidate.object.name()},
                                {"log_evidence", score.log_evidence},
                                {"visible_sd", score.visible}});
  }
  return json;
}

std::string DiagnosisText(const Diagnosis& diagnosis, const HeldOutGain& gain, bool verbose) {
  std::string text =
      fmt::format("verdict: {}\nchi-square per row {:.3f}, with the causes found {:.3f}\n",
                  Name(diagnosis.verdict), diagnosis.chi_before, diagnosis.chi_after);
  text += LeftoversText(diagnosis.leftovers, verbose);
  text += FindingsText(diagnosis, gain);
  if (gain.rows > 0) {
    text += fmt::format(
        "\nheld out: {} rows, rms {:.3f} of the stated noise without the causes found, {:.3f} with "
        "them\n",
        gain.rows, gain.before, gain.after);
  }
  if (!diagnosis.findings.empty() && diagnosis.map_change > 0.0) {
    text += fmt::format("the error map of the machine changes by up to {:.2g} um\n",
                        1e6 * diagnosis.map_change);
  }
  if (gain.arm_poses > 0) {
    text += fmt::format(
        "{} poses of arms held out: {:.4g} mm rms in space, {:.4g} mm with the causes "
        "found\n",
        gain.arm_poses, 1e3 * gain.arm_before, 1e3 * gain.arm_after);
  }
  text += EvidenceText(diagnosis);
  if (!diagnosis.cannot_show.empty()) {
    text += fmt::format("\nThese runs cannot show: {}\n", fmt::join(diagnosis.cannot_show, ", "));
  }
  return text;
}

std::string ModelText(simulation::ExtendedModel model,
                      const std::vector<std::filesystem::path>& recordings) {
  for (const std::filesystem::path& path : recordings) {
    model.sources.push_back({path.filename().string(), recording::Sha256OfFile(path)});
  }
  return simulation::ExtendedModelText(model);
}

}  // namespace abbe::apps
