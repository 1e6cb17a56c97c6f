#include "standards/circularity.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <tuple>
#include <utility>

#include "failure/failure.h"

namespace abbe::standards {
namespace {

// [largest, smallest] distance to the centre minus `radius`.
std::pair<double, double> RadialRange(const Circle& about, const PlanePath& path) {
  const std::vector<double> deviations = RadialDeviations(about, path.x, path.y);
  const auto [low, high] = std::minmax_element(deviations.begin(), deviations.end());
  return {*high, *low};
}

// `arcs`: what each point of the path stands for (ArcsOf).
SenseFigures Evaluate(const PlanePath& path, const std::vector<double>& arcs, double radius,
                      std::string_view sense) {
  try {
    const Roundness zone = EvaluateRoundness(CircleKind::kMinimumZone, path.x, path.y);
    const Roundness squares = EvaluateRoundness(CircleKind::kLeastSquares, path.x, path.y, arcs);
    const auto [F_max, F_min] = RadialRange({0.0, 0.0, radius}, path);
    return {zone.Error(), squares.Error(), zone.circle, squares.circle, F_max, F_min};
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", sense, error.what()));
  }
}

PlanePath Joined(const PlanePath& a, const PlanePath& b) {
  PlanePath joined = a;
  joined.x.insert(joined.x.end(), b.x.begin(), b.x.end());
  joined.y.insert(joined.y.end(), b.y.begin(), b.y.end());
  return joined;
}

}  // namespace

Circularity EvaluateCircularity(const CircularPaths& paths) {
  if (!(paths.radius > 0.0)) {
    throw InputError(fmt::format(
        "circular test with a nominal radius of {} m: give the radius of the programmed circle",
        paths.radius));
  }
  if (paths.cw.x.empty() && paths.ccw.x.empty()) {
    throw InputError("circular test without a point in either sense: nothing to evaluate");
  }
  Circularity figures;
  std::vector<double> arcs = ArcsOf(paths.cw.x, paths.cw.y);
  const std::vector<double> others = ArcsOf(paths.ccw.x, paths.ccw.y);
  if (!paths.cw.x.empty()) figures.cw = Evaluate(paths.cw, arcs, paths.radius, "clockwise");
  if (!paths.ccw.x.empty()) {
    figures.ccw = Evaluate(paths.ccw, others, paths.radius, "counter-clockwise");
  }
  const PlanePath all = Joined(paths.cw, paths.ccw);
  arcs.insert(arcs.end(), others.begin(), others.end());
  if (figures.cw && figures.ccw) figures.both = Evaluate(all, arcs, paths.radius, "both senses");
  const SenseFigures& widest = figures.both ? *figures.both
                               : figures.cw ? *figures.cw
                                            : *figures.ccw;
  figures.F_max = widest.F_max;
  figures.F_min = widest.F_min;
  const Circle centre{widest.least_squares.x, widest.least_squares.y, paths.radius};
  std::tie(figures.F_max_ls, figures.F_min_ls) = RadialRange(centre, all);
  if (figures.both) figures.D = widest.least_squares.radius - paths.radius;
  return figures;
}

}  // namespace abbe::standards
