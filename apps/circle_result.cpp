#include "apps/circle_result.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <optional>

#include "estimation/parameter.h"
#include "settings/unit.h"
#include "standards/circle.h"
#include "standards/coverage.h"

namespace abbe::apps {
namespace {

using nlohmann::ordered_json;
using paths::CircleFigures;
using paths::CirclePoint;
using paths::CircleRun;
using settings::Mm;
using settings::Um;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr int kProfilePoints = 360;  // of the profile in the result, one per degree

double MmPerMin(double speed) { return Mm(speed) * 60.0; }
double Degrees(double angle) { return angle * 360.0 / kTurn; }

ordered_json HarmonicData(const std::optional<standards::HarmonicFit>& fit) {
  ordered_json list = ordered_json::array();
  if (!fit) return list;
  for (const standards::Harmonic& wave : fit->harmonics) {
    list.push_back({{"order", wave.order},
                    {"amplitude_um", Um(wave.Amplitude())},
                    {"phase_deg", Degrees(wave.Phase())}});
  }
  return list;
}

// Means over one degree each, about `centre`: radius minus nominal, its part that the
// causes explain, and the third coordinate.
ordered_json Profile(const CircleRun& run, int sense, const standards::Circle& centre,
                     const std::vector<double>* residuals) {
  std::vector<double> radial(kProfilePoints), explained(kProfilePoints), axial(kProfilePoints),
      count(kProfilePoints);
  for (std::size_t i = 0; i < run.points.size(); ++i) {
    const CirclePoint& point = run.points[i];
    if (point.sense != sense) continue;
    const double x = point.first - centre.x, y = point.second - centre.y;
    const double part = std::atan2(y, x) / kTurn;
    const auto bin = std::min<std::size_t>(
        kProfilePoints - 1, static_cast<std::size_t>((part - std::floor(part)) * kProfilePoints));
    const double deviation = std::hypot(x, y) - run.radius;
    radial[bin] += deviation;
    if (residuals != nullptr) explained[bin] += deviation - (*residuals)[i];
    axial[bin] += point.third;
    count[bin] += 1.0;
  }
  ordered_json profile;
  for (std::size_t bin = 0; bin < kProfilePoints; ++bin) {
    if (count[bin] == 0.0) continue;
    profile["angle"].push_back((bin + 0.5) * kTurn / kProfilePoints);
    profile["radial"].push_back(radial[bin] / count[bin]);
    if (residuals != nullptr) profile["explained"].push_back(explained[bin] / count[bin]);
    if (run.third_seen) profile["axial"].push_back(axial[bin] / count[bin]);
  }
  return profile;
}

// The least-squares centre of both senses.
standards::Circle Centre(const CircleFigures& figures) {
  const auto& iso = figures.iso;
  return iso.both  ? iso.both->least_squares
         : iso.ccw ? iso.ccw->least_squares
                   : iso.cw->least_squares;
}

ordered_json RunData(const CircleRun& run, const CircleFigures& figures,
                     const FigureUncertainties& u, const std::vector<double>* residuals) {
  ordered_json data{{"feed_mm_min", MmPerMin(run.feed)},
                    {"points", run.points.size()},
                    {"left_out_rows", run.left_out}};
  for (const std::string& recording : run.recordings) {
    data["recordings"].push_back(std::filesystem::path(recording).filename().string());
  }
  ordered_json calibration, noise;
  for (std::size_t i = 0; i < kCircleFigures.size(); ++i) {
    const CircleFigure& figure = kCircleFigures[i];
    const Figure value = figure.of(figures);
    if (!value) continue;
    data[figure.key] = Um(*value);
    data["u"][figure.key] = Um(u[i].Total());
    calibration[figure.key] = Um(u[i].calibration);
    noise[figure.key] = Um(u[i].noise);
  }
  data["u_calibration"] = std::move(calibration);
  data["u_noise"] = std::move(noise);
  data["partial"] = run.Partial();
  const standards::Circle centre = Centre(figures);
  data["setup_offset_um"] = {Um(centre.x), Um(centre.y)};
  for (const auto& [name, sense] : {std::pair{"ccw", 1}, std::pair{"cw", -1}}) {
    const auto first = std::ranges::find(run.points, sense, &CirclePoint::sense);
    if (first != run.points.end()) data["start_deg"][name] = Degrees(first->angle);
  }
  data["covered_deg"] = {{"cw", Degrees(run.Covered(-1))}, {"ccw", Degrees(run.Covered(1))}};
  data["harmonics"] = {{"cw", HarmonicData(figures.cw)}, {"ccw", HarmonicData(figures.ccw)}};
  for (const auto& [name, sense] : {std::pair{"ccw", 1}, std::pair{"cw", -1}}) {
    const ordered_json profile = Profile(run, sense, centre, residuals);
    if (!profile.empty()) data["profile"][name] = profile;
  }
  return data;
}

estimation::PrintUnit DisplayUnit(const std::string& unit) {
  if (unit == "m") return {"um", 1e-6};
  if (unit == "rad") return {"urad", 1e-6};
  if (unit == "s") return {"us", 1e-6};
  if (unit == "s2") return {"ms2", 1e-6};
  return {"ppm", 1e-6};
}

std::string CauseTable(const fusion::CircleCauses& causes) {
  std::string text = fmt::format("  {:<28}{:>12}{:>10}{:>7}{:>16}\n", "cause", "value", "U95",
                                 "unit", "on the radius");
  for (const fusion::CauseEstimate& one : causes.causes) {
    const estimation::PrintUnit shown = DisplayUnit(one.unit);
    const std::string alike = one.alike.empty() ? "" : " or " + one.alike;
    const std::string name = one.cause + " " + one.object + alike;
    if (!one.seen) {
      text += fmt::format("  {:<28}{:>12}{:>10.2f}{:>7}{:>16}\n", name, "not seen",
                          standards::kCoverage * one.u / shown.si, shown.name, "-");
      continue;
    }
    text += fmt::format("  {:<28}{:>12.2f}{:>10.2f}{:>7}{:>13.2f} um{}\n", name,
                        one.value / shown.si, standards::kCoverage * one.u / shown.si, shown.name,
                        Um(one.effect), causes.IsCertain(one) ? " *" : "");
  }
  text += fmt::format(
      "  rms of the radius {:.2f} um, smooth errors without a cause {:.2f} um, unexplained {:.2f} "
      "um; * beyond its U95\n",
      Um(causes.rms_before), Um(causes.rms_smooth), Um(causes.rms_after));
  if (causes.TableHolds()) return text;
  return text + fmt::format(
                    "  what is unexplained is {:.1f} times the scatter from point to point: the "
                    "machine does something that is not in this table, or the instrument drifts; "
                    "no cause below {:g} times as much has a star\n",
                    causes.beyond_noise, fusion::CircleCauses::kStandsOut);
}

std::string FigureText(double value, double U) {
  if (U == 0.0) return fmt::format("{:.2f}", Um(value));
  return fmt::format("{:.2f} +- {:.2f}", Um(value), Um(U));
}

}  // namespace

ordered_json CircleJson(const Circle& circle) {
  const CircleRun& first = circle.runs.front();
  ordered_json data{
      {"instrument", first.instrument},
      {"plane", first.plane.name},
      {"radius_mm", Mm(first.radius)},
      {"radius_is", first.is_programmed ? "programmed" : "recorded"},
      {"centre_mm", {Mm(first.centre.x()), Mm(first.centre.y()), Mm(first.centre.z())}},
      {"filter_undulations", circle.cutoff}};
  if (first.plane.Inclined()) {
    data["normal"] = {first.plane.third.x(), first.plane.third.y(), first.plane.third.z()};
  }
  for (std::size_t i = 0; i < circle.runs.size(); ++i) {
    data["runs"].push_back(RunData(circle.runs[i], circle.figures[i], circle.uncertainties[i],
                                   circle.causes ? &circle.causes->residuals[i] : nullptr));
  }
  if (!circle.causes) return data;
  for (const fusion::CauseEstimate& one : circle.causes->causes) {
    data["causes"].push_back({{"cause", one.cause},
                              {"object", one.object},
                              {"value", one.value},
                              {"unit", one.unit},
                              {"u", one.u},
                              {"effect_um", Um(one.effect)},
                              {"seen", one.seen}});
    data["causes"].back()["certain"] = circle.causes->IsCertain(one);
    if (!one.alike.empty()) data["causes"].back()["or"] = one.alike;
  }
  data["rms_before_um"] = Um(circle.causes->rms_before);
  data["rms_smooth_um"] = Um(circle.causes->rms_smooth);
  data["rms_after_um"] = Um(circle.causes->rms_after);
  data["unexplained_over_noise"] = circle.causes->beyond_noise;
  data["weak_directions"] = circle.causes->weak_directions;
  return data;
}

std::string CircleTable(const std::vector<Circle>& circles) {
  std::string instruments, feeds, covered;
  bool partial = false;
  for (const Circle& circle : circles) {
    for (const CircleRun& run : circle.runs) {
      instruments += fmt::format("{:>20}", run.instrument + " " + run.plane.name);
      feeds +=
          fmt::format("{:>20}", fmt::format("R{:.4g} F{:.4g}", Mm(run.radius), MmPerMin(run.feed)));
      covered += fmt::format("{:>20}", fmt::format("{:.0f}, {:.0f}", Degrees(run.Covered(1)),
                                                   Degrees(run.Covered(-1))));
      partial = partial || run.Partial();
    }
  }
  std::string text = fmt::format("{:<40}{}\n{:<40}{}\n", "ISO 230-4, um, +- U95", instruments,
                                 "radius mm, feed mm/min", feeds);
  if (partial) text += fmt::format("{:<40}{}\n", "PART OF THE CIRCLE, degrees ccw, cw", covered);
  for (std::size_t i = 0; i < kCircleFigures.size(); ++i) {
    std::string line;
    bool any = false;
    for (const Circle& circle : circles) {
      for (std::size_t run = 0; run < circle.runs.size(); ++run) {
        const Figure value = kCircleFigures[i].of(circle.figures[run]);
        any = any || value.has_value();
        const double U = standards::kCoverage * circle.uncertainties[run][i].Total();
        line += fmt::format("{:>20}", value ? FigureText(*value, U) : "-");
      }
    }
    if (any) text += fmt::format("{:<40}{}\n", kCircleFigures[i].text, line);
  }
  for (const Circle& circle : circles) {
    if (!circle.causes) continue;
    const CircleRun& run = circle.runs.front();
    text += fmt::format("\nCauses by one joint fit, {} {}, R {:.4g} mm, {} feed{}\n",
                        run.instrument, run.plane.name, Mm(run.radius), circle.runs.size(),
                        circle.runs.size() == 1 ? "" : "s");
    text += CauseTable(*circle.causes);
  }
  return text;
}

}  // namespace abbe::apps
