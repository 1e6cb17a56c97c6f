#include "apps/history_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "apps/rounded.h"
#include "recording/instant.h"
#include "settings/unit.h"

namespace abbe::apps {
namespace {

// A chance that underflows is not 0.
std::string ChanceText(double p) { return p > 0.0 ? fmt::format("{:.2g}", p) : "< 1e-300"; }

using history::Judged;
using history::Trend;
using history::Verdict;

constexpr double kMonth = 30.0 * 86400.0;  // s

std::string DayText(double seconds) { return recording::InstantText(seconds).substr(0, 10); }

std::string WithConditions(const std::string& text, const std::string& conditions) {
  return conditions.empty() ? text : fmt::format("{} ({})", text, Printable(conditions));
}

std::string FigureText(const history::Figure& figure) {
  if (!figure.u) return fmt::format("{:>14}{:>10}", Decimals(0.0)(figure.value), "-");
  const Decimals shown(figure.U95());
  return fmt::format("{:>14}{:>10}", shown(figure.value), shown(figure.U95()));
}

std::string JoinedFindings(const std::vector<history::Finding>& findings) {
  std::vector<std::string> names;
  names.reserve(findings.size());
  for (const auto& each : findings) names.push_back(Printable(each.cause + ":" + each.object));
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::string Printable(const std::string& text) {
  std::string clean = text;
  std::ranges::replace_if(
      clean, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  return clean;
}

std::string QuantityUnit(const std::string& quantity) {
  if (quantity == "urad") return "urad";
  return std::string(settings::UnitOf(quantity).name);
}

std::string QuantityName(const std::string& name) {
  std::string text(settings::StemOf(name));
  if (text.ends_with(".urad")) text = text.substr(0, text.size() - 5) + " squareness";
  std::ranges::replace(text, '.', ' ');
  std::ranges::replace(text, '_', ' ');
  return Printable(text);
}

std::string CampaignTable(const std::vector<history::CampaignHead>& campaigns) {
  std::string text = fmt::format("{:>8}  {:<20}{:<24}{:>8}{:>11}{:>6}  {}\n", "campaign",
                                 "measured", "machine", "results", "recordings", "maps", "note");
  for (const auto& each : campaigns) {
    text += fmt::format("{:>8}  {:<20}{:<24}{:>8}{:>11}{:>6}  {}\n", each.id,
                        recording::InstantText(each.measured).substr(0, 16),
                        Printable(each.machine), each.results, each.recordings, each.maps,
                        Printable(each.note.empty() ? each.name : each.note));
  }
  return text;
}

std::string CampaignText(const history::StoredCampaign& campaign) {
  const auto& head = campaign.head;
  std::string text =
      fmt::format("campaign {} of {}, measured {}, added {}\n", head.id, Printable(head.machine),
                  recording::InstantText(head.measured), recording::InstantText(head.added));
  for (const auto& [name, value] : {std::pair{"operator", head.who}, std::pair{"folder", head.name},
                                    std::pair{"note", head.note}}) {
    if (!value.empty()) text += fmt::format("{}: {}\n", name, Printable(value));
  }
  for (const auto& [role, name] : campaign.instruments) {
    text += fmt::format("{}: {}\n", Printable(role), Printable(name));
  }
  if (campaign.machine_file) {
    text += fmt::format("machine file: {}, sha256 {}\n", Printable(campaign.machine_file->name),
                        campaign.machine_file->sha256);
  }
  for (const auto& each : campaign.recordings) {
    text += fmt::format("recording: {}, sha256 {}\n", Printable(each.path), each.sha256);
  }
  for (const auto& each : campaign.maps) {
    text += fmt::format("map: {}, sha256 {}\n", Printable(each.name), each.sha256);
  }
  for (const auto& result : campaign.results) {
    text += fmt::format("\n{}{}{}\n", Printable(result.file),
                        result.extract.verdict.empty() ? "" : ", verdict ",
                        Printable(result.extract.verdict));
    if (!result.extract.figures.empty()) {
      text += fmt::format("  {:<44}{:>14}{:>10}  {}\n", "figure", "value", "U95", "unit");
    }
    for (const auto& each : result.extract.figures) {
      text += fmt::format("  {:<44}{}  {}\n", WithConditions(each.Name(), each.conditions),
                          FigureText(each), QuantityUnit(each.quantity));
    }
    for (const auto& each : result.extract.findings) {
      text += fmt::format("  finding {}:{}, probability {:.3f}\n", Printable(each.cause),
                          Printable(each.object), each.probability);
    }
  }
  return text;
}

std::string ChangeText(const history::Difference& difference) {
  const std::string unit = QuantityUnit(difference.quantity);
  const std::string name = difference.is_curve
                               ? fmt::format("{} at {:.6g} mm", difference.object, difference.at_mm)
                               : QuantityName(difference.Name());
  const Decimals shown(difference.U95.value_or(0.0));
  // Away from zero or towards it: what a machinist asks.
  const double growth = std::abs(difference.after) - std::abs(difference.before);
  const bool same_side = difference.before * difference.after >= 0.0;
  const std::string verb = !same_side || difference.is_curve ? "changed"
                           : growth > 0.0                    ? "grew"
                                                             : "fell";
  const double amount = verb == "changed" ? difference.change : std::abs(difference.change);
  return fmt::format("{} {} by {}{} {}, from {} to {} {}",
                     WithConditions(name, difference.conditions), verb, shown(amount),
                     difference.U95 ? " +- " + shown(*difference.U95) : "", unit,
                     shown(difference.before), shown(difference.after), unit);
}

std::string ComparisonText(const history::Comparison& comparison) {
  const auto& differences = comparison.differences;
  std::string text = fmt::format("{}: campaign {} ({}) after campaign {} ({})\n",
                                 Printable(comparison.after.machine), comparison.after.id,
                                 DayText(comparison.after.measured), comparison.before.id,
                                 DayText(comparison.before.measured));
  const auto judged =
      std::ranges::count_if(differences, [](const auto& each) { return each.p.has_value(); });
  const auto significant =
      std::ranges::count_if(differences, [](const auto& each) { return each.significant; });
  text += fmt::format(
      "{} of {} differences are significant; the chance of any false one among them all is below "
      "{:.0f} % (Holm)\n",
      significant, judged, 100.0 * comparison.level);
  for (const auto& each : differences) {
    if (each.significant) text += fmt::format("  {}\n", ChangeText(each));
  }
  text += fmt::format("\n{:<48}{:>12}{:>12}{:>12}{:>10}{:>10}  {}\n", "figure", "before", "after",
                      "change", "U95", "p", "in common");
  for (const auto& each : differences) {
    const Decimals shown(each.U95.value_or(0.0));
    text += fmt::format("{:<48}{:>12}{:>12}{:>12}{:>10}{:>10}  {}\n",
                        WithConditions(each.Name(), each.conditions), shown(each.before),
                        shown(each.after), shown(each.change) + (each.significant ? "*" : ""),
                        each.U95 ? shown(*each.U95) : "-", each.p ? ChanceText(*each.p) : "-",
                        fmt::join(each.shared, ", "));
  }
  const auto list = [&](const char* what, const auto& names) {
    if (!names.empty()) text += fmt::format("{}: {}\n", what, fmt::join(names, ", "));
  };
  list("only before", comparison.only_before);
  list("only after", comparison.only_after);
  if (!comparison.new_findings.empty()) {
    text += fmt::format("causes found that were not there before: {}\n",
                        JoinedFindings(comparison.new_findings));
  }
  if (!comparison.gone_findings.empty()) {
    text += fmt::format("causes no longer found: {}\n", JoinedFindings(comparison.gone_findings));
  }
  return text;
}

namespace {

// The line is beyond the limit; whether the machine is, only the last campaign can say.
std::string BeyondText(const Trend& trend) {
  const std::string unit = QuantityUnit(trend.quantity);
  const history::Point& last = trend.Last();
  const std::string limit = fmt::format("its limit of {:g} {}", *trend.limit, unit);
  if (trend.MeasuredBeyond()) return fmt::format("; it is beyond {}", limit);
  const auto& since = trend.reached->expected;
  return fmt::format("; expected to be beyond {}{}; last measured {} {} on {}", limit,
                     since ? fmt::format(" since {} if the drift went on", DayText(*since)) : "",
                     Decimals(last.figure.U95())(last.figure.value), unit, DayText(last.measured));
}

}  // namespace

std::string DriftText(const Trend& trend) {
  if (!trend.fit) return "";
  const auto& fit = *trend.fit;
  const std::string unit = QuantityUnit(trend.quantity);
  const double U = kMonth * fit.U95_rate;
  std::string text =
      fit.drifts
          ? fmt::format("it changes by {} {} a month", PlusMinus(kMonth * fit.rate, U), unit)
          : fmt::format("no drift is seen: {} {} a month", PlusMinus(kMonth * fit.rate, U), unit);
  if (fit.excess > 0.0) {
    text += fmt::format("; beyond their uncertainty the campaigns scatter by {:.2g} {} rms",
                        fit.excess, unit);
    if (fit.memory > 0.0) {
      text += fmt::format(", correlated by {:.2g} from one to the next", fit.memory);
    }
  }
  if (!trend.limit) return text;
  if (!trend.reached) {
    return text + fmt::format("; it moves away from its limit of {:g} {}", *trend.limit, unit);
  }
  const auto& reached = *trend.reached;
  if (reached.already) return text + BeyondText(trend);
  if (reached.expected) {
    return text + fmt::format("; its limit of {:g} {} is reached about {} (between {} and {})",
                              *trend.limit, unit, DayText(*reached.expected),
                              DayText(*reached.earliest), DayText(*reached.latest));
  }
  if (reached.earliest) {
    return text + fmt::format("; its limit of {:g} {} is reached on {} at the earliest",
                              *trend.limit, unit, DayText(*reached.earliest));
  }
  return text + fmt::format("; its limit of {:g} {} is not in sight", *trend.limit, unit);
}

std::string TrendText(const Trend& trend) {
  const std::string unit = QuantityUnit(trend.quantity);
  const std::string name =
      trend.object.empty() ? trend.quantity : trend.object + "." + trend.quantity;
  std::string text = fmt::format("{}, {}\n{:>10}  {:<18}{:>12}{:>10}\n",
                                 WithConditions(QuantityName(name), trend.conditions), unit,
                                 "campaign", "measured", "value", "U95");
  for (const auto& each : trend.points) {
    const Decimals shown(each.point.figure.U95());
    text += fmt::format(
        "{:>10}  {:<18}{:>12}{:>10}{}\n", each.point.campaign,
        recording::InstantText(each.point.measured).substr(0, 16), shown(each.point.figure.value),
        each.point.figure.u ? shown(each.point.figure.U95()) : "-", each.used ? "" : "  left out");
  }
  if (const std::string drift = DriftText(trend); !drift.empty()) text += "  " + drift + "\n";
  for (const std::string& note : trend.notes) text += "  note: " + note + "\n";
  return text;
}

std::string CheckText(const std::vector<Judged>& judged) {
  std::string text = fmt::format("{:<52}{:>12}{:>10}{:>10}  {:<6}{}\n", "figure", "value", "U95",
                                 "limit", "unit", "verdict");
  for (const Judged& each : judged) {
    const std::string name =
        each.object.empty() ? each.limit.quantity : each.object + "." + each.limit.quantity;
    const bool measured = each.verdict != Verdict::kNotMeasured;
    const Decimals shown(each.U95.value_or(0.0));
    text +=
        fmt::format("{:<52}{:>12}{:>10}{:>10}  {:<6}{}{}\n", WithConditions(name, each.conditions),
                    measured ? shown(each.value) : "-", each.U95 ? shown(*each.U95) : "-",
                    fmt::format("{:g}", each.limit.size), QuantityUnit(each.limit.quantity),
                    Name(each.verdict), each.reason.empty() ? "" : ": " + each.reason);
  }
  return text +
         "pass: |value| + U95 <= limit; fail: |value| - U95 > limit; undecided: neither is proven "
         "(ISO 14253-1)\n";
}

}  // namespace abbe::apps
