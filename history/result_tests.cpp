// Positioning, circular and other path tests.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "history/result_reader.h"

namespace abbe::history {
namespace {

// A measured mean feed as it was programmed: three digits.
double ProgrammedFeed(double mean) {
  if (!(mean > 0.0) || !std::isfinite(mean)) return 0.0;
  const double last = std::pow(10.0, std::floor(std::log10(mean)) - 2.0);
  return std::round(mean / last) * last;
}

std::string CircleConditions(const Json& circle, const Json& run) {
  return fmt::format("{}, R {:.4g} mm, F {:g}", TextAt(circle, "instrument"),
                     NumberAt(circle, "radius_mm").value_or(0.0),
                     ProgrammedFeed(NumberAt(run, "feed_mm_min").value_or(0.0)));
}

void ReadCircleRun(const Json& circle, const Json& run, Extract& extract) {
  const std::string plane = TextAt(circle, "plane"), conditions = CircleConditions(circle, run);
  const auto add = [&](const std::string& quantity, const std::string& key) {
    const auto value = NumberAt(run, key);
    if (!value) return;
    const auto u = NumberAt(ObjectAt(run, "u"), key);
    Shares shares;
    const auto calibration = NumberAt(ObjectAt(run, "u_calibration"), key);
    if (calibration && u && *u > 0.0) {
      shares["linkage"] = (*calibration / *u) * (*calibration / *u);
    }
    extract.figures.push_back(
        {plane, quantity, conditions, *value, u, standards::kCoverage, std::move(shares)});
  };
  const bool both = run.contains("G_b_um");
  add("circularity_um", both ? "G_b_um" : run.contains("G_ccw_um") ? "G_ccw_um" : "G_cw_um");
  if (both) {
    for (const char* const key : {"G_ccw_um", "G_cw_um"}) add(key, key);
  }
  for (const char* const key : {"F_max_um", "F_min_um", "D_um", "out_of_plane_um"}) add(key, key);
}

constexpr std::array<std::pair<const char*, const char*>, 6> kPositioning{
    {{"A_um", "positioning_A_um"},
     {"R_um", "positioning_R_um"},
     {"E_um", "positioning_E_um"},
     {"M_um", "positioning_M_um"},
     {"B_um", "positioning_B_um"},
     {"mean_reversal_um", "positioning_reversal_um"}}};

constexpr std::array<const char*, 7> kPathFigures{
    "largest_um",  "rms_um",   "aligned_largest_um", "aligned_rms_um",
    "location_um", "range_um", "two_sigma_um"};

}  // namespace

void ReadPositioning(const Json& result, Extract& extract) {
  const Json& figures = ObjectAt(result, "iso230_2");
  const std::string axis = TextAt(result, "axis");
  for (const auto& [key, quantity] : kPositioning) {
    const auto value = NumberAt(figures, key);
    if (value) extract.figures.push_back({axis, quantity, "", *value, {}});
  }
  Curve curve{axis, "um", "positioning", {}, {}, {}};
  for (const Json& target : ObjectAt(figures, "targets")) {
    const auto at = NumberAt(target, "target_mm"), mean = NumberAt(target, "mean_um");
    if (!at || !mean) continue;
    curve.positions_mm.push_back(*at);
    curve.value.push_back(*mean);
  }
  if (!curve.value.empty()) extract.curves.push_back(std::move(curve));
}

void ReadCircle(const Json& result, Extract& extract) {
  for (const Json& circle : ObjectAt(result, "circles")) {
    for (const Json& run : ObjectAt(circle, "runs")) ReadCircleRun(circle, run, extract);
  }
}

void ReadPath(const Json& result, Extract& extract) {
  const std::string kind = TextAt(result, "kind");
  for (const Json& test : ObjectAt(result, "tests")) {
    const std::string instrument = TextAt(test, "instrument");
    for (const char* const key : kPathFigures) {
      const auto value = NumberAt(test, key);
      if (value) extract.figures.push_back({kind, key, instrument, *value, {}});
    }
    for (const Json& line : ObjectAt(test, "lines")) {
      const auto along = NumberAt(line, "largest_along_um");
      if (!along) continue;
      extract.figures.push_back({TextAt(line, "axis"), "stepping_um", instrument, *along, {}});
    }
    std::map<std::string, std::vector<double>> sides;
    for (const Json& side : ObjectAt(test, "sides")) {
      const auto straightness = NumberAt(side, "straightness_mz_um");
      if (straightness) sides[TextAt(side, "axis")].push_back(*straightness);
    }
    for (const auto& [axis, values] : sides) {
      extract.figures.push_back(
          {axis, "side_straightness_um", instrument, *std::ranges::max_element(values), {}});
    }
  }
}

}  // namespace abbe::history
