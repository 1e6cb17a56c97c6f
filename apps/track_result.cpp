#include "apps/track_result.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "apps/map_json.h"
#include "apps/rounded.h"
#include "recording/instant.h"
#include "settings/unit.h"
#include "standards/coverage.h"

namespace abbe::apps {
namespace {

using Eigen::Vector3d;
using nlohmann::ordered_json;
using settings::kMicro;
using standards::kCoverage;

constexpr int kTrackedStations = 61;
constexpr double kDayOfResult = 86400.0;

bool IsLength(int error) { return error < map::kErrors - 3 && error % machine::kMotions < 3; }

// Largest amount over the travel, and largest U95, um or urad.
struct Extent {
  double amount = 0.0, U95 = 0.0;
};

Extent ExtentOf(const map::ErrorMap& map, int error) {
  Eigen::VectorXd stations = Eigen::VectorXd::Zero(1);
  if (error < map::kErrors - 3) {
    const auto& travel = map.model().travels()[error / machine::kMotions];
    stations = Eigen::VectorXd::LinSpaced(kTrackedStations, travel.first, travel.last);
  }
  const auto curve = map.CurveOf(error, stations);
  return {curve.value.cwiseAbs().maxCoeff() / kMicro, kCoverage * curve.u.maxCoeff() / kMicro};
}

std::string TestsText(const std::vector<TestReport>& tests) {
  if (tests.empty()) return {};
  std::string text = fmt::format("{:<24}{:<11}{:<22}{:>6}{:>8}{:>10}{:>16}\n", "test", "kind",
                                 "began", "min", "noise", "p", "U95 um");
  for (const TestReport& each : tests) {
    text += fmt::format("{:<24}{:<11}{:<22}{:>6.1f}", each.name, each.kind,
                        recording::InstantText(each.began), each.minutes);
    if (each.after > 0.0) {
      text += fmt::format("{:>8.2f}{:>10.2g}{:>16}", each.noise, each.agreement.probability,
                          fmt::format("{:.2f} -> {:.2f}", 1e6 * each.before, 1e6 * each.after));
    } else {
      text += "    temperatures alone";
    }
    text += '\n';
  }
  return text +
         "noise: over the stated one; p: of the agreement with the map before it;\n"
         "U95: the largest over the volume, before and after it\n\n";
}

std::string LearnedText(const LearnedReport& learned) {
  std::string text = fmt::format(
      "learned from the tests (log likelihood + {:.1f}): after a day positioning {:.3g} um, "
      "straightness {:.3g} um, roll {:.3g}, pitch {:.3g}, yaw {:.3g}, squareness {:.3g} urad, scale "
      "{:.3g} ppm\n",
      learned.gain, learned.walk.positioning / kMicro, learned.walk.straightness / kMicro,
      learned.walk.roll / kMicro, learned.walk.pitch / kMicro, learned.walk.yaw / kMicro,
      learned.walk.squareness / kMicro, learned.walk.scale / kMicro);
  for (const map::Warmth& each : learned.sensors) {
    text += fmt::format("follows {} with a lag of {:.0f} s\n", each.sensor, each.lag);
  }
  return text + "\n";
}

std::string ErrorsText(const map::ErrorMap& map) {
  std::string text = fmt::format("{:<8}{:>12}{:>10}\n", "error", "largest", "U95");
  for (int error = 0; error < map::kErrors; ++error) {
    const Extent extent = ExtentOf(map, error);
    if (extent.U95 == 0.0) continue;
    const Decimals decimals(extent.U95);
    text += fmt::format("{:<8}{:>12}{:>10} {}\n", map::ErrorName(error), decimals(extent.amount),
                        decimals(extent.U95), IsLength(error) ? "um" : "urad");
  }
  return text;
}

std::string WatchedText(const std::vector<track::Watched>& watched, double now) {
  if (watched.empty()) return {};
  std::string text = fmt::format("\n{:<28}{:>10}{:>10}  {}\n", "limit", "of", "U95", "exceeded");
  for (const track::Watched& each : watched) {
    const std::string when =
        !each.exceeded ? "not within ten years"
        : *each.exceeded <= now
            ? "now"
            : fmt::format("{} ({:.1f} days)", recording::InstantText(*each.exceeded),
                          (*each.exceeded - now) / kDayOfResult);
    text += fmt::format("{:<28}{:>10.4g}{:>10.3g}  {}\n", each.name, each.limit, each.U95, when);
  }
  return text;
}

std::string ChoiceText(const track::Choice& choice, double days) {
  if (choice.enough && choice.tests.empty()) {
    return fmt::format("\nno test is needed for {:g} days\n", days);
  }
  if (choice.tests.empty()) {
    return fmt::format("\nnone of these tests helps for {:g} days; measure and fuse anew\n", days);
  }
  const std::string tests = fmt::format("{}", fmt::join(choice.tests, " and "));
  if (choice.enough) {
    return fmt::format("\nnext: {}, {:.1f} min, keeps every U95 below its limit for {:g} days\n",
                       tests, choice.minutes, days);
  }
  const auto worst = std::max_element(choice.after.begin(), choice.after.end(),
                                      [](const auto& one, const auto& other) {
                                        return one.U95 / one.limit < other.U95 / other.limit;
                                      });
  return fmt::format(
      "\nnone of these tests keeps every limit for {:g} days; best are {}, {:.1f} min, with {} at "
      "{:.3g} of {:.4g}\n",
      days, tests, choice.minutes, worst->name, worst->U95, worst->limit);
}

ordered_json WatchedJson(const std::vector<track::Watched>& watched) {
  ordered_json list = ordered_json::array();
  for (const track::Watched& each : watched) {
    ordered_json one{{"name", each.name}, {"limit", each.limit}, {"U95", each.U95}};
    if (each.exceeded) one["exceeded"] = recording::InstantText(*each.exceeded);
    list.push_back(std::move(one));
  }
  return list;
}

}  // namespace

double MinutesOf(const recording::Recording& recording) {
  const auto time = recording.Find("time_s");
  if (!time || time->empty() || !recording.KnowsTimes()) return 0.0;
  return (time->back() - time->front()) / 60.0;
}

double LargestU95(const map::ErrorMap& map) {
  const auto& travels = map.model().travels();
  double largest = 0.0;
  for (int corner = 0; corner < 9; ++corner) {
    Vector3d place;
    for (int axis = 0; axis < 3; ++axis) {
      const double share = corner == 8 ? 0.5 : static_cast<double>((corner >> axis) & 1);
      place[axis] = travels[axis].first + share * (travels[axis].last - travels[axis].first);
    }
    largest =
        std::max(largest, kCoverage * map.StandardUncertainty(place, map.origin().tool).maxCoeff());
  }
  return largest;
}

ordered_json TrackJson(const map::ErrorMap& map, const TrackReport& report) {
  ordered_json json{{"abbe", ABBE_VERSION},
                    {"command", "track"},
                    {"machine", map.origin().machine},
                    {"chain", map.model().chain().Text()},
                    {"time", recording::InstantText(map.state()->time)}};
  json["temperatures"] = ordered_json::object();
  for (const map::Warmth& each : map.state()->sensors) {
    json["temperatures"][each.sensor] = {
        {"temperature_c", each.temperature}, {"lagged_c", each.lagged}, {"lag_s", each.lag}};
  }
  json["tests"] = ordered_json::array();
  for (const TestReport& each : report.tests) {
    json["tests"].push_back({{"test", each.name},
                             {"kind", each.kind},
                             {"started", recording::InstantText(each.began)},
                             {"minutes", each.minutes},
                             {"noise", each.noise},
                             {"agreement",
                              {{"statistic", each.agreement.statistic},
                               {"directions", each.agreement.directions},
                               {"p", each.agreement.probability}}},
                             {"U95_before_um", 1e6 * each.before},
                             {"U95_after_um", 1e6 * each.after}});
  }
  if (report.learned) {
    json["learned"] = {{"factor", report.learned->factor},
                       {"log_likelihood_gain", report.learned->gain}};
  }
  json["limits"] = WatchedJson(report.watched);
  if (report.choice) {
    json["next"] = {{"days", report.days},
                    {"enough", report.choice->enough},
                    {"tests", report.choice->tests},
                    {"minutes", report.choice->minutes},
                    {"limits_then", WatchedJson(report.choice->after)}};
  }
  if (report.at) {
    const Vector3d error = map.Error(*report.at, map.origin().tool);
    const Vector3d u = map.StandardUncertainty(*report.at, map.origin().tool);
    json["at"] = {
        {"position_mm", {1e3 * report.at->x(), 1e3 * report.at->y(), 1e3 * report.at->z()}},
        {"error_um", {1e6 * error.x(), 1e6 * error.y(), 1e6 * error.z()}},
        {"U95_um", {2e6 * u.x(), 2e6 * u.y(), 2e6 * u.z()}}};
  }
  json["map"] = MapJson(map);
  return json;
}

std::string TrackText(const map::ErrorMap& map, const TrackReport& report) {
  const map::MapState& state = *map.state();
  std::string text;
  if (report.learned) text += LearnedText(*report.learned);
  text += TestsText(report.tests);
  text +=
      fmt::format("the map of {} at {}", map.origin().machine, recording::InstantText(state.time));
  for (const map::Warmth& each : state.sensors) {
    text += fmt::format(", {} {:.2f} degC", each.sensor, each.temperature);
  }
  text += "\n";
  if (report.at) {
    const Vector3d error = map.Error(*report.at, map.origin().tool);
    const Vector3d u = map.StandardUncertainty(*report.at, map.origin().tool);
    text += fmt::format("error at X {:g} Y {:g} Z {:g} mm:", 1e3 * report.at->x(),
                        1e3 * report.at->y(), 1e3 * report.at->z());
    for (int k = 0; k < 3; ++k) {
      text +=
          fmt::format(" {:c} {} um", 'X' + k, PlusMinus(1e6 * error[k], kCoverage * 1e6 * u[k]));
    }
    text += "\n";
  } else {
    text += ErrorsText(map);
  }
  text += WatchedText(report.watched, state.time);
  if (report.choice) text += ChoiceText(*report.choice, report.days);
  if (!report.out.empty()) text += fmt::format("\nmap: {}\n", report.out.string());
  return text;
}

}  // namespace abbe::apps
