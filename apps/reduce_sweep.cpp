#include "apps/reduce_sweep.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "apps/rounded.h"
#include "standards/coverage.h"

namespace abbe::apps {
namespace {

using nlohmann::ordered_json;
using probes::ComponentResult;
using probes::LineFigure;
using probes::SweepResult;

constexpr double kToMicro = 1e6;       // m -> um, rad -> urad
constexpr double kToNano = 1e9;        // m -> nm
constexpr double kToMillimetre = 1e3;  // m -> mm

ordered_json NumbersOf(const Eigen::VectorXd& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

ordered_json UncertainData(const probes::Uncertain& quantity) {
  return {{"value", quantity.value}, {"u", quantity.u}};
}

// A station in mm with three decimals; no sign if it rounds to zero.
double Shown(double station) { return std::round(station * 1e6) / 1e3 + 0.0; }

std::string_view UnitOf(const ComponentResult& c) { return c.component.angle() ? "rad" : "m"; }

std::string ProbeName(std::size_t probe) { return fmt::format("probe_{:c}", 'a' + probe); }

ordered_json ConditionsData(const probes::SweepConditions& conditions) {
  ordered_json data;
  for (const auto& [name, spread] : conditions.temperatures) {
    data[name] = {{"min", spread.min}, {"max", spread.max}, {"mean", spread.mean}};
  }
  data["duration_s"] = conditions.duration;
  data["feed_mm_min"] = conditions.feed * kToMillimetre * 60.0;
  return data;
}

ordered_json ErrorData(const ComponentResult& c) {
  ordered_json data{{"unit", UnitOf(c)},
                    {"kind", c.component.kind},
                    {"coverage", c.coverage},
                    {"value", NumbersOf(c.value)},
                    {"u", NumbersOf(c.u)}};
  if (c.forward.size() > 0) data["forward"] = NumbersOf(c.forward);
  if (c.backward.size() > 0) data["backward"] = NumbersOf(c.backward);
  return data;
}

ordered_json LineData(const LineFigure& figure) {
  return {{"slope", figure.line.slope}, {"offset", figure.line.offset}};
}

// Adds the result of one component.
void AddComponent(const ComponentResult& c, ordered_json& data) {
  const std::string& name = c.component.name;
  data["errors"][name] = ErrorData(c);
  data["errors_at_target"][name] = {{"value", NumbersOf(c.at_target)},
                                    {"u", NumbersOf(c.u_at_target)}};
  if (c.straightness) {
    const probes::StraightnessFigures& s = *c.straightness;
    data["straightness"][name] = {{"end_points", s.end_points.error},
                                  {"least_squares", s.least_squares.error},
                                  {"minimum_zone", s.minimum_zone.error},
                                  {"u", s.u}};
    data["straightness_lines"][name] = {{"end_points", LineData(s.end_points)},
                                        {"least_squares", LineData(s.least_squares)},
                                        {"minimum_zone", LineData(s.minimum_zone)}};
    data["slopes"][name] = UncertainData(s.slope);
  }
  if (c.range) data["angular_ranges"][name] = UncertainData(*c.range);
  if (c.reversal) {
    data["reversal"][name] = {{"value", NumbersOf(c.reversal->value)},
                              {"u", NumbersOf(c.reversal->u)},
                              {"mean", UncertainData(c.reversal->mean)},
                              {"max", UncertainData(c.reversal->largest)},
                              {"seen", c.reversal->seen}};
  }
  for (std::size_t source = 0; source < probes::kSources; ++source) {
    data["budget"][name][std::string(probes::kSourceNames[source])] = c.budget[source];
  }
}

void AddDwells(const SweepResult& result, ordered_json& data) {
  for (std::size_t probe = 0; probe < probes::kProbes; ++probe) {
    data["residuals"][ProbeName(probe)] = NumbersOf(result.residual.row(probe).transpose());
  }
  ordered_json& dwells = data["dwells"];
  for (const probes::Dwell& dwell : result.dwells) {
    dwells["time_s"].push_back(dwell.time);
    dwells["station"].push_back(dwell.station);
    dwells["direction"].push_back(dwell.direction);
    dwells["pass"].push_back(dwell.pass);
  }
}

ordered_json NoiseData(const probes::NoiseFigures& noise) {
  ordered_json data;
  for (std::size_t probe = 0; probe < probes::kProbes; ++probe) {
    const probes::ProbeFigures& figures = noise.probes[probe];
    data[ProbeName(probe)] = {
        {"white_m", figures.white}, {"lag1", figures.lag1}, {"drift_m", figures.drift}};
  }
  data["chi2"] = noise.chi2;
  data["dof"] = noise.dof;
  data["scale"] = noise.scale;
  return data;
}

// The mean reversal "0.31 +- 0.12", with a star if it is significant.
std::string Cell(const std::optional<probes::Reversal>& reversal, double coverage) {
  if (!reversal) return "-";
  const double expanded = coverage * reversal->mean.u;
  return PlusMinus(reversal->mean.value * kToMicro, expanded * kToMicro) +
         (reversal->seen ? '*' : ' ');
}

std::string AngleTable(const SweepResult& result) {
  std::string text =
      fmt::format("{:<22}{:>10}{:>10}{:>22}\n", "angle, urad", "range", "U95", "mean reversal");
  for (const ComponentResult& c : result.components) {
    if (!c.range) continue;
    const double U = c.coverage * c.range->u * kToMicro;
    const Decimals shown(U);
    text += fmt::format("  {} {:<16}{:>10}{:>10}{:>22}\n", c.component.name, c.component.kind,
                        shown(c.range->value * kToMicro), shown(U), Cell(c.reversal, c.coverage));
  }
  return text;
}

std::string StraightnessTable(const SweepResult& result) {
  std::string text =
      fmt::format("{:<22}{:>10}{:>10}{:>22}{:>12}{:>14}{:>14}\n", "straightness, um", "least sq.",
                  "U95", "mean reversal", "end points", "minimum zone", "slope, urad");
  for (const ComponentResult& c : result.components) {
    if (!c.straightness) continue;
    const probes::StraightnessFigures& s = *c.straightness;
    const double U = c.coverage * s.u * kToMicro;
    const Decimals shown(U), of_slope(c.coverage * s.slope.u * kToMicro);
    text += fmt::format("  {:<20}{:>10}{:>10}{:>22}{:>12}{:>14}{:>14}\n", c.component.name,
                        shown(s.least_squares.error * kToMicro), shown(U),
                        Cell(c.reversal, c.coverage), shown(s.end_points.error * kToMicro),
                        shown(s.minimum_zone.error * kToMicro), of_slope(s.slope.value * kToMicro));
  }
  return text;
}

std::string NoiseText(const probes::NoiseFigures& noise) {
  std::string text = "noise of one reading, nm:";
  for (std::size_t probe = 0; probe < probes::kProbes; ++probe) {
    text += fmt::format(" {:c} {:.1f}", 'a' + probe, noise.probes[probe].white * kToNano);
  }
  if (noise.dof <= 0.0) return text + "; one pass, no check\n";
  return text + fmt::format("; scatter between passes: chi2 {:.0f} for {:.0f} degrees of freedom\n",
                            noise.chi2, noise.dof);
}

}  // namespace

ordered_json SweepJson(const SweepResult& result) {
  ordered_json data{
      {"abbe", ABBE_VERSION},
      {"command", "reduce"},
      {"kind", "sweep"},
      {"recording", std::filesystem::path(result.recording).filename().string()},
      {"machine", result.machine},
      {"chain", result.chain},
      {"axis", std::string(1, result.axis)},
      {"positive", result.positive},
      {"moves", result.moving == probes::MovingBody::kTarget ? "target" : "head"},
      {"started", result.conditions.started},
      {"simulated", result.conditions.simulated},
      {"conditions", ConditionsData(result.conditions)},
      {"stations", result.stations},
      {"passes", result.passes},
      {"samples",
       {{"rows", result.counts.rows},
        {"used", result.counts.used},
        {"flagged", result.counts.flagged},
        {"moving", result.counts.moving},
        {"outliers", result.counts.outliers}}},
  };
  if (result.planned) {
    data["planned"] = {{"stations", result.planned->stations},
                       {"passes", result.planned->passes},
                       {"missing_stations", result.planned->missing_stations},
                       {"missing_passes", result.planned->missing_passes}};
  }
  for (const ComponentResult& component : result.components) AddComponent(component, data);
  AddDwells(result, data);
  data["noise"] = NoiseData(result.noise);
  data["notes"] = result.notes;
  return data;
}

std::string SweepTable(const SweepResult& result) {
  const probes::SampleCounts& counts = result.counts;
  std::string text = fmt::format(
      "{} axis of {} {}, the {} moves, + as the {} goes: {} stations from {:.3f} to {:.3f} mm, {} "
      "passes\n",
      result.axis, result.machine, result.chain,
      result.moving == probes::MovingBody::kTarget ? "target" : "head", result.positive,
      result.stations.size(), Shown(result.stations.front()), Shown(result.stations.back()),
      result.passes);
  text += AngleTable(result) + StraightnessTable(result);
  text +=
      "  reversal: forward - backward, mean over the stations, +- U95; * beyond chance (1 % for "
      "all of three axes)\n";
  text += NoiseText(result.noise);
  text += fmt::format("rows: {} read, {} used, {} flagged, {} moving; {} outliers\n", counts.rows,
                      counts.used, counts.flagged, counts.moving, counts.outliers);
  if (result.conditions.simulated) text += "note: simulated readings, no machine was measured\n";
  for (const std::string& note : result.notes) text += fmt::format("note: {}\n", note);
  return text;
}

ordered_json SquarenessJson(const probes::SquarenessResult& result) {
  return {{"abbe", ABBE_VERSION},        {"command", "reduce"},         {"kind", "squareness"},
          {"name", result.name},         {"value", result.value},       {"u", result.u},
          {"u_slopes", result.u_slopes}, {"u_target", result.u_target}, {"line", "least_squares"}};
}

std::string SquarenessLine(const probes::SquarenessResult& result) {
  const double U = standards::kCoverage * result.u * kToMicro;
  return fmt::format("squareness {}: {} urad (least-squares lines; U95, of it the target {})\n",
                     result.name, PlusMinus(result.value * kToMicro, U),
                     Decimals(U)(standards::kCoverage * result.u_target * kToMicro));
}

}  // namespace abbe::apps
