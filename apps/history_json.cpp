#include "apps/history_json.h"

#include <algorithm>

#include "apps/history_text.h"
#include "recording/instant.h"

namespace abbe::apps {
namespace {

using nlohmann::ordered_json;
using recording::InstantText;

constexpr double kDay = 86400.0;
constexpr int kBandPoints = 41;  // of the fitted line with its band

ordered_json OrNull(const std::optional<double>& value) {
  return value ? ordered_json(*value) : ordered_json();
}

ordered_json InstantOrNull(const std::optional<double>& instant) {
  return instant ? ordered_json(InstantText(*instant)) : ordered_json();
}

ordered_json Head(const char* kind) {
  return {{"abbe", ABBE_VERSION}, {"command", "history"}, {"kind", kind}};
}

ordered_json HeadJson(const history::CampaignHead& head) {
  return {{"campaign", head.id},
          {"machine", head.machine},
          {"serial", head.serial},
          {"measured", InstantText(head.measured)},
          {"added", InstantText(head.added)},
          {"folder", head.name},
          {"operator", head.who},
          {"note", head.note},
          {"results", head.results},
          {"recordings", head.recordings},
          {"maps", head.maps}};
}

ordered_json FigureJson(const history::Figure& figure) {
  return {{"name", figure.Name()},           {"object", figure.object},
          {"quantity", figure.quantity},     {"unit", QuantityUnit(figure.quantity)},
          {"conditions", figure.conditions}, {"value", figure.value},
          {"u", OrNull(figure.u)},           {"coverage", figure.coverage},
          {"shares", figure.shares}};
}

ordered_json CurveJson(const history::Curve& curve) {
  return {{"object", curve.object},         {"unit", curve.unit},
          {"conditions", curve.conditions}, {"positions_mm", curve.positions_mm},
          {"value", curve.value},           {"u", curve.u},
          {"coverage", curve.coverage},     {"shares", curve.shares}};
}

ordered_json FindingsJson(const std::vector<history::Finding>& findings) {
  ordered_json list = ordered_json::array();
  for (const auto& each : findings) {
    list.push_back(
        {{"cause", each.cause}, {"object", each.object}, {"probability", each.probability}});
  }
  return list;
}

ordered_json PointJson(const history::TrendPoint& each) {
  const auto& figure = each.point.figure;
  return {{"campaign", each.point.campaign},
          {"measured", InstantText(each.point.measured)},
          {"value", figure.value},
          {"U95", figure.u ? ordered_json(figure.U95()) : ordered_json()},
          {"u_own", each.u_own},
          {"used", each.used}};
}

// The fitted line from the first point to the last, or to where the limit is met.
ordered_json LineJson(const history::Trend& trend) {
  double first = trend.points.front().point.measured, last = first;
  for (const auto& each : trend.points) {
    if (each.used) last = std::max(last, each.point.measured);
  }
  const double beyond = last + (last - first);  // no farther than the history is long
  if (trend.reached && trend.reached->expected && *trend.reached->expected > last) {
    last = std::min(beyond, *trend.reached->expected);
  }
  ordered_json line;
  for (int i = 0; i < kBandPoints; ++i) {
    const double at = first + (last - first) * i / (kBandPoints - 1);
    line["measured"].push_back(InstantText(at));
    line["value"].push_back(trend.fit->At(at));
    line["U95"].push_back(trend.fit->U95At(at));
  }
  return line;
}

ordered_json TrendJson(const history::Trend& trend) {
  ordered_json json{
      {"object", trend.object},
      {"quantity", trend.quantity},
      {"name",
       QuantityName(trend.object.empty() ? trend.quantity : trend.object + "." + trend.quantity)},
      {"unit", QuantityUnit(trend.quantity)},
      {"conditions", trend.conditions},
      {"signed", history::IsSigned(trend.quantity)},
      {"limit", OrNull(trend.limit)}};
  for (const auto& each : trend.points) json["points"].push_back(PointJson(each));
  if (trend.fit) {
    const auto& fit = *trend.fit;
    json["fit"] = {{"at", InstantText(fit.at)},
                   {"value", fit.value},
                   {"U95_value", fit.U95_value},
                   {"rate_per_day", kDay * fit.rate},
                   {"U95_rate_per_day", kDay * fit.U95_rate},
                   {"excess_scatter", fit.excess},
                   {"memory", fit.memory},
                   {"coverage", fit.coverage},
                   {"drifts", fit.drifts}};
    json["line"] = LineJson(trend);
    json["words"] = DriftText(trend);
  }
  if (trend.reached) {
    json["limit_reached"] = {{"already", trend.reached->already},
                             {"measured", trend.MeasuredBeyond()},
                             {"expected", InstantOrNull(trend.reached->expected)},
                             {"earliest", InstantOrNull(trend.reached->earliest)},
                             {"latest", InstantOrNull(trend.reached->latest)}};
  }
  json["notes"] = trend.notes;
  return json;
}

}  // namespace

ordered_json CampaignsJson(const std::vector<history::CampaignHead>& campaigns) {
  ordered_json json = Head("campaigns");
  json["campaigns"] = ordered_json::array();
  for (const auto& each : campaigns) json["campaigns"].push_back(HeadJson(each));
  return json;
}

ordered_json CampaignJson(const history::StoredCampaign& campaign) {
  ordered_json json = Head("campaign");
  json.update(HeadJson(campaign.head));
  json["instruments"] = campaign.instruments;
  if (campaign.machine_file) {
    json["machine_file"] = {{"name", campaign.machine_file->name},
                            {"sha256", campaign.machine_file->sha256},
                            {"content", campaign.machine_file->content}};
  }
  json["recordings"] = ordered_json::array();
  for (const auto& each : campaign.recordings) {
    json["recordings"].push_back({{"path", each.path},
                                  {"sha256", each.sha256},
                                  {"bytes", each.bytes},
                                  {"kind", each.kind},
                                  {"started", each.started}});
  }
  json["maps"] = ordered_json::array();
  for (const auto& each : campaign.maps) {
    json["maps"].push_back(
        {{"file", each.name}, {"sha256", each.sha256}, {"content", each.content}});
  }
  json["results"] = ordered_json::array();
  for (const auto& result : campaign.results) {
    ordered_json one{{"file", result.file},
                     {"sha256", result.sha256},
                     {"measured", InstantText(result.measured)},
                     {"verdict", result.extract.verdict},
                     {"figures", ordered_json::array()},
                     {"curves", ordered_json::array()},
                     {"findings", FindingsJson(result.extract.findings)}};
    for (const auto& each : result.extract.figures) one["figures"].push_back(FigureJson(each));
    for (const auto& each : result.extract.curves) one["curves"].push_back(CurveJson(each));
    one["result"] = ordered_json::parse(result.content, nullptr, /*allow_exceptions=*/false);
    json["results"].push_back(std::move(one));
  }
  return json;
}

ordered_json ComparisonJson(const history::Comparison& comparison) {
  ordered_json json = Head("comparison");
  json["machine"] = comparison.after.machine;
  json["before"] = HeadJson(comparison.before);
  json["after"] = HeadJson(comparison.after);
  json["family_level"] = comparison.level;
  json["differences"] = ordered_json::array();
  for (const auto& each : comparison.differences) {
    ordered_json one{{"name", each.is_curve ? each.object + " curve" : QuantityName(each.Name())},
                     {"object", each.object},
                     {"quantity", each.quantity},
                     {"unit", QuantityUnit(each.quantity)},
                     {"conditions", each.conditions},
                     {"before", each.before},
                     {"after", each.after},
                     {"change", each.change},
                     {"U95", OrNull(each.U95)},
                     {"p", OrNull(each.p)},
                     {"significant", each.significant},
                     {"shared", each.shared},
                     {"words", ChangeText(each)}};
    if (each.is_curve) {
      one["at_mm"] = each.at_mm;
      one["curve"] = {
          {"positions_mm", each.positions_mm}, {"change", each.changes}, {"U95", each.U95s}};
    }
    json["differences"].push_back(std::move(one));
  }
  json["only_before"] = comparison.only_before;
  json["only_after"] = comparison.only_after;
  json["new_findings"] = FindingsJson(comparison.new_findings);
  json["gone_findings"] = FindingsJson(comparison.gone_findings);
  return json;
}

ordered_json TrendsJson(const std::string& machine, const std::vector<history::Trend>& trends,
                        const std::vector<std::string>& notes) {
  ordered_json json = Head("trend");
  json["machine"] = machine;
  json["series"] = ordered_json::array();
  for (const auto& each : trends) json["series"].push_back(TrendJson(each));
  json["notes"] = notes;
  return json;
}

ordered_json CheckJson(const std::string& machine, const std::string& of,
                       const std::vector<history::Judged>& judged) {
  ordered_json json = Head("check");
  json["machine"] = machine;
  json["of"] = of;
  json["rule"] = "pass: |value| + U95 <= limit; fail: |value| - U95 > limit (ISO 14253-1)";
  ordered_json counts{{"pass", 0}, {"fail", 0}, {"undecided", 0}, {"not measured", 0}};
  json["checks"] = ordered_json::array();
  for (const auto& each : judged) {
    const std::string verdict(Name(each.verdict));
    counts[verdict] = counts[verdict].get<int>() + 1;
    const std::string name =
        each.object.empty() ? each.limit.quantity : each.object + "." + each.limit.quantity;
    const bool measured = each.verdict != history::Verdict::kNotMeasured;
    json["checks"].push_back({{"name", QuantityName(name)},
                              {"object", each.object},
                              {"quantity", each.limit.quantity},
                              {"unit", QuantityUnit(each.limit.quantity)},
                              {"conditions", each.conditions},
                              {"value", measured ? ordered_json(each.value) : ordered_json()},
                              {"U95", OrNull(each.U95)},
                              {"U95_from", each.u_from_limit ? "machine file" : "result"},
                              {"limit", each.limit.size},
                              {"verdict", verdict},
                              {"reason", each.reason}});
  }
  json["counts"] = std::move(counts);
  return json;
}

}  // namespace abbe::apps
