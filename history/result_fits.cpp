// Error maps, calibrations of the linkage and diagnoses.
#include <algorithm>
#include <cmath>

#include "history/result_reader.h"
#include "settings/unit.h"
#include "standards/straightness.h"

namespace abbe::history {
namespace {

// Bounds of the standard uncertainty of a figure of a curve whose correlations are not stated:
// whatever they are, u(a - b) <= u(a) + u(b), and a deviation from a line moves a zone by no more
// than twice the largest deviation.
void AddCurveFigures(const Curve& curve, Extract& extract) {
  const auto [least, most] = std::ranges::minmax_element(curve.value);
  const bool states_u = curve.u.size() == curve.value.size();
  const auto u_at = [&](auto at) {
    return curve.u[static_cast<std::size_t>(at - curve.value.begin())];
  };
  extract.figures.push_back({curve.object, "range_" + curve.unit, "map", *most - *least,
                             states_u ? std::optional(u_at(least) + u_at(most)) : std::nullopt});
  const bool is_straightness = curve.unit == "um" && curve.object[1] != curve.object[2];
  if (!is_straightness || curve.value.size() < 3) return;
  const auto zone = standards::EvaluateStraightness(standards::LineKind::kMinimumZone,
                                                    curve.positions_mm, curve.value);
  extract.figures.push_back(
      {curve.object, "straightness_um", "map", zone.error,
       states_u ? std::optional(2.0 * *std::ranges::max_element(curve.u)) : std::nullopt});
}

// The largest error vector over the grid of a map, and the largest that u of its length can be.
void AddVolumetric(const Json& grid, Extract& extract) {
  const Json &error = ObjectAt(grid, "error"), &u = ObjectAt(grid, "u");
  if (error.size() != 3) return;
  double largest = -1.0, u_largest = 0.0;
  for (std::size_t point = 0; point < error[0].size(); ++point) {
    double squares = 0.0, along = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double e = error.at(axis).at(point).get<double>();
      squares += e * e;
      if (u.size() == 3) along += std::abs(e) * u.at(axis).at(point).get<double>();
    }
    if (std::sqrt(squares) <= largest) continue;
    largest = std::sqrt(squares);
    u_largest = largest > 0.0 ? along / largest : 0.0;
  }
  if (largest < 0.0) return;
  extract.figures.push_back({"", "volumetric_um", "map", kToMicro * largest,
                             u.size() == 3 ? std::optional(kToMicro * u_largest) : std::nullopt});
}

// The part of the scale's variance that comes from the certificate of the only calibrated length or
// plate: its prior, which all its lengths have in common.
Shares ScaleShares(const Json& result, double u_ppm) {
  std::vector<double> certificates;
  for (const Json& parameter : ObjectAt(result, "parameters")) {
    const std::string name = TextAt(parameter, "name");
    const auto prior = NumberAt(parameter, "prior");
    if (prior && (name.starts_with("length_scale ") || name.starts_with("reference_scale ") ||
                  name.starts_with("plate_scale "))) {
      certificates.push_back(*prior);
    }
  }
  if (certificates.size() != 1 || !(u_ppm > 0.0)) return {};
  const double part = certificates.front() / u_ppm;
  return {{"length", std::min(1.0, part * part)}};
}

}  // namespace

void ReadMap(const Json& result, Extract& extract) {
  const Json& scale = ObjectAt(result, "scale");
  if (const auto value = NumberAt(scale, "value_ppm")) {
    const auto u = NumberAt(scale, "u_ppm");
    extract.figures.push_back({"", "scale_ppm", "map", *value, u, standards::kCoverage,
                               u ? ScaleShares(result, *u) : Shares{}});
  }
  for (const auto& [name, error] : ObjectAt(ObjectAt(result, "map"), "errors").items()) {
    if (const auto squareness = NumberAt(error, "value")) {
      const auto u = NumberAt(error, "u");
      extract.figures.push_back({name, "urad", "map", kToMicro * *squareness,
                                 u ? std::optional(kToMicro * *u) : std::nullopt});
      continue;
    }
    const Curve curve{name,
                      ShownUnit(TextAt(error, "unit")),
                      "map",
                      ListAt(error, "positions", kToMillimetre),
                      ListAt(error, "value", kToMicro),
                      ListAt(error, "u", kToMicro)};
    if (name.size() != 3 || curve.value.empty() ||
        curve.positions_mm.size() != curve.value.size()) {
      continue;
    }
    AddCurveFigures(curve, extract);
    extract.curves.push_back(curve);
  }
  AddVolumetric(ObjectAt(ObjectAt(result, "map"), "grid"), extract);
}

void ReadCalibration(const Json& result, Extract& extract) {
  for (const auto& [key, quantity] :
       {std::pair{"after", "rms_um"}, std::pair{"held_out", "held_out_rms_um"}}) {
    const auto rms = NumberAt(ObjectAt(result, key), "rms_um");
    if (rms) extract.figures.push_back({"linkage", quantity, "", *rms, {}});
  }
  for (const Json& parameter : ObjectAt(result, "parameters")) {
    const auto value = NumberAt(parameter, "value");
    if (!value) continue;
    extract.figures.push_back(
        {"linkage", TextAt(parameter, "name") + "_" + TextAt(parameter, "unit"),
         TextAt(result, "model"), *value, NumberAt(parameter, "uncertainty")});
  }
}

void ReadDiagnosis(const Json& result, Extract& extract) {
  extract.verdict = TextAt(result, "verdict");
  for (const Json& finding : ObjectAt(result, "findings")) {
    const std::string cause = TextAt(finding, "cause"), object = TextAt(finding, "object");
    extract.findings.push_back({cause, object, NumberAt(finding, "probability").value_or(0.0)});
    for (const Json& parameter : ObjectAt(finding, "parameters")) {
      const auto value = NumberAt(parameter, "value"), u95 = NumberAt(parameter, "u95");
      if (!value || !u95) continue;
      extract.figures.push_back({object, cause + "_" + TextAt(parameter, "name"), "diagnosis",
                                 *value, *u95 / standards::kCoverage});
    }
  }
}

}  // namespace abbe::history
