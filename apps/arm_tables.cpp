#include "apps/arm_tables.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string_view>
#include <vector>

#include "settings/unit.h"

namespace abbe::apps {
namespace {

using nlohmann::ordered_json;
using settings::kMillimetre;

// A number that is written: theta_deg of row 3.
struct Number {
  std::string of, key;
  double was, is, u95;  // in the unit of the key
};

// Rows that the file did not have were nothing before: NaN.
std::vector<Number> NumbersOf(const fusion::ArmCalibration& found) {
  const Eigen::VectorXd now = found.written.Numbers(), was = found.nominal.Numbers();
  Eigen::Index at = 0, old = 0;
  std::vector<Number> numbers;
  const auto take = [&](const std::string& of, const std::vector<const char*>& keys, bool is_new) {
    for (const char* key : keys) {
      const double unit = settings::UnitOf(key).si;
      const double nominal = is_new ? std::numeric_limits<double>::quiet_NaN() : was[old++];
      numbers.push_back({of, key, nominal / unit, now[at] / unit, found.u95[at] / unit});
      ++at;
    }
  };
  std::size_t old_row = 0;
  for (std::size_t i = 0; i < found.written.rows.size(); ++i) {
    const bool is_new = found.written.rows[i].fixed && (old_row >= found.nominal.rows.size() ||
                                                        !found.nominal.rows[old_row].fixed);
    take(fmt::format("row {}", i + 1), {"theta_deg", "d_mm", "a_mm", "alpha_deg"}, is_new);
    if (!is_new) ++old_row;
  }
  for (std::size_t i = 0; i < found.written.axes.size(); ++i) {
    take(fmt::format("axis {}", i + 1),
         {"x_mm", "y_mm", "z_mm", "direction_x", "direction_y", "direction_z"}, false);
  }
  take("ball", {"x_mm", "y_mm", "z_mm"}, false);
  return numbers;
}

ordered_json Json(const fusion::ArmFigures& run) {
  const auto distances = [](const fusion::Distances& d) {
    return ordered_json{{"rms_mm", d.rms / kMillimetre}, {"max_mm", d.max / kMillimetre}};
  };
  return {{"recording", std::filesystem::path(run.name).filename().string()},
          {"poses", run.poses},
          {"left_out", run.left_out},
          {"before", distances(run.before)},
          {"after", distances(run.after)}};
}

std::string Line(std::string_view what, const fusion::ArmFigures& run) {
  std::string text = fmt::format("  {:<12}{:<28}{:>6}{:>12.4f}{:>10.4f}{:>12.4f}{:>10.4f}\n", what,
                                 std::filesystem::path(run.name).filename().string(), run.poses,
                                 run.before.rms / kMillimetre, run.before.max / kMillimetre,
                                 run.after.rms / kMillimetre, run.after.max / kMillimetre);
  if (run.left_out > 0) {
    text += fmt::format("  {:<12}{} poses are off what fits the others and left out\n", "",
                        run.left_out);
  }
  return text;
}

// What the geometry does not explain; empty: nothing.
std::string LeftText(const fusion::ArmCalibration& found) {
  const bool is_no_noise = found.no_noise > 0.5;
  if (found.excess <= 1.0 && !is_no_noise) return "";
  std::string text = "\n";
  if (found.excess > 1.0) {
    text += fmt::format("The geometry leaves {:.3g} times the stated noise. ", found.excess);
  }
  text += is_no_noise
              ? fmt::format(
                    "What it leaves goes with the posture or the time (probability {:.3f}): "
                    "the numbers may hide more of it, which U95 estimates from what is left",
                    found.no_noise)
              : "What it leaves looks like noise, and U95 counts it as such";
  return text + "; abbe diagnose looks for its causes, and --causes takes them out first.\n";
}

}  // namespace

ordered_json ArmCalibrationJson(const fusion::ArmCalibration& found, const std::string& machine) {
  ordered_json numbers = ordered_json::array(), balls = ordered_json::array();
  for (const Number& number : NumbersOf(found)) {
    ordered_json entry{{"of", number.of}, {"key", number.key}, {"value", number.is}};
    entry["u95"] = number.u95;
    if (std::isfinite(number.was)) entry["nominal"] = number.was;
    numbers.push_back(entry);
  }
  for (const auto& [name, p] : found.balls) {
    balls.push_back(
        {{"ball", name},
         {"place_mm", {p.x() / kMillimetre, p.y() / kMillimetre, p.z() / kMillimetre}}});
  }
  ordered_json runs = ordered_json::array(), tests = ordered_json::array();
  for (const auto& run : found.runs) runs.push_back(Json(run));
  for (const auto& test : found.tests) tests.push_back(Json(test));
  return {{"abbe", ABBE_VERSION},
          {"command", "calibrate"},
          {"kind", "arm calibration"},
          {"machine", machine},
          {"form", found.written.rows.empty() ? "axes" : "denavit-hartenberg"},
          {"recordings", runs},
          {"tests", tests},
          {"residuals_over_noise", found.excess},
          {"residuals_no_noise", found.no_noise},
          {"numbers", numbers},
          {"balls", balls}};
}

std::string ArmCalibrationTable(const fusion::ArmCalibration& found) {
  std::string text = fmt::format(
      "  {:<40}{:>6}{:>22}{:>22}\n  {:<40}{:>6}{:>12}{:>10}{:>12}{:>10}\n", "ball position, 3D, mm",
      "", "as the file has it", "corrected", "", "poses", "rms", "max", "rms", "max");
  for (const auto& run : found.runs) text += Line("fitted", run);
  for (const auto& test : found.tests) text += Line("test", test);
  text += fmt::format("\n{:<10}{:<14}{:>16}{:>16}{:>12}\n", "", "", "was", "is", "U95");
  for (const Number& number : NumbersOf(found)) {
    const std::string was =
        std::isfinite(number.was) ? fmt::format("{:.6f}", number.was) : std::string("-");
    text += fmt::format("{:<10}{:<14}{:>16}{:>16.6f}{:>12}\n", number.of, number.key, was,
                        number.is, number.u95 > 0.0 ? fmt::format("{:.2g}", number.u95) : "held");
  }
  for (const auto& [name, p] : found.balls) {
    text += fmt::format("ball \"{}\": {:.4f}, {:.4f}, {:.4f} mm in the same frame as ball\n", name,
                        p.x() / kMillimetre, p.y() / kMillimetre, p.z() / kMillimetre);
  }
  text += LeftText(found);
  if (found.tests.empty()) text += "No test set: give poses that took no part by --check.\n";
  return text;
}

}  // namespace abbe::apps
