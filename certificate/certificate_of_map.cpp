#include "certificate/certificate_of_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "failure/failure.h"
#include "map/axis_tables.h"

namespace abbe::certificate {
namespace {

using machine::kMotions;
using map::kErrors;

constexpr int kMotionErrors = kErrors - 3;

bool IsLength(int error) { return error < kMotionErrors && error % kMotions < 3; }

bool HasAxis(const map::ErrorMap& map, char axis) {
  return map.model().chain().Text().find(axis) != std::string::npos;
}

// The axes that an error belongs to: of a squareness, both.
std::string AxesOf(int error) {
  constexpr std::array<const char*, 3> kPairs{"YZ", "XZ", "XY"};
  return error < kMotionErrors ? std::string(1, "XYZ"[error / kMotions])
                               : kPairs[error - kMotionErrors];
}

std::string WordsOf(const map::ErrorMap& map, int error) {
  const std::string axes = AxesOf(error);
  std::string what;
  if (error >= kMotionErrors) {
    what = fmt::format("squareness of {} and {}", axes[0], axes[1]);
  } else {
    const int axis = error / kMotions, motion = error % kMotions;
    const char along = "XYZ"[motion % 3];
    if (motion >= 3) {
      what = fmt::format("turn of {} about {}", axes, along);
    } else {
      what = motion == axis ? fmt::format("positioning of {}", axes)
                            : fmt::format("straightness of {} in {}", axes, along);
    }
  }
  const auto source = map.origin().SourceOf(error);
  return source == map::kPriorOnly ? what + "; prior only: no run determines it"
                                   : fmt::format("{}; determined by: {}", what, source);
}

std::vector<double> ListOf(const Eigen::VectorXd& values) {
  return {values.data(), values.data() + values.size()};
}

Series SeriesOf(const map::ErrorMap& map, int error, Eigen::Index count) {
  Series series;
  series.name = map::ErrorName(error);
  series.words = WordsOf(map, error);
  series.unit = IsLength(error) ? "m" : "rad";
  Eigen::VectorXd positions = Eigen::VectorXd::Zero(1);
  if (error < kMotionErrors) {
    const machine::Travel& travel = map.model().travels()[error / kMotions];
    positions = Eigen::VectorXd::LinSpaced(count, travel.first, travel.last);
    series.positions = ListOf(positions);
  }
  const auto curve = map.CurveOf(error, positions);
  series.values = ListOf(curve.value);
  series.U95 = ListOf(standards::kCoverage * curve.u);
  return series;
}

Joint JointOf(const map::ErrorMap& map) {
  Joint joint;
  joint.words =
      fmt::format("parameters of the map of the chain {} ({}), with the covariance of all of them",
                  map.model().chain().Text(), map.model().chain().PositiveText());
  const auto names = map.ParameterNames();
  joint.values = ListOf(map.model().Parameters());
  for (const std::string& name : names) {
    joint.names.push_back(name);
    const int error = map::ErrorNamed(name.substr(0, 3));
    joint.units.emplace_back(error >= 0 && IsLength(error) ? "m" : "rad");
  }
  // Symmetric: columns are rows.
  joint.covariance = ListOf(map.cov_pp().reshaped());
  return joint;
}

// The values of all tables, one after the other.
Eigen::VectorXd ValuesOfTables(const map::ErrorMap& map, Eigen::Index count) {
  const auto tables = map::Tabulate(map, map.origin().tool, {count, count, count});
  Eigen::VectorXd values(kMotionErrors * count);
  for (int error = 0; error < kMotionErrors; ++error) {
    const auto& one = tables.errors[error].values;
    values.segment(error * count, count) = Eigen::Map<const Eigen::VectorXd>(one.data(), count);
  }
  return values;
}

// For a table of the tool, an error of a carriage adds to others: the turn of X about Z moves the
// tool in Y, by the way that X has gone. First order, by central differences of one standard
// uncertainty.
Eigen::VectorXd UncertaintyOfTables(const map::ErrorMap& map, Eigen::Index count) {
  const Eigen::VectorXd at = map.model().Parameters();
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(kMotionErrors * count, at.size());
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    const double step = std::sqrt(map.cov_pp()(i, i));
    if (!(step > 0.0)) continue;
    const auto moved = [&](double by) {
      Eigen::VectorXd parameters = at;
      parameters[i] += by;
      machine::VolumetricModel model = map.model();
      model.SetParameters(parameters);
      return ValuesOfTables({map.origin(), model, {}}, count);
    };
    J.col(i) = (moved(step) - moved(-step)) / (2.0 * step);
  }
  return (J * map.cov_pp()).cwiseProduct(J).rowwise().sum().cwiseMax(0.0).cwiseSqrt();
}

void RefuseOtherSenses(const map::ErrorMap& map) {
  for (const char axis : {'X', 'Y', 'Z'}) {
    if (!HasAxis(map, axis)) {
      throw InputError(fmt::format(
          "the machine has no axis {}; QIF describes three axes: take --format dcc", axis));
    }
    if (map.model().chain().ToolSense(axis) < 0.0) {
      throw InputError(fmt::format(
          "axis {} counts against the tool (positive = \"carriage\"), which QIF cannot say: take "
          "--format dcc",
          axis));
    }
  }
}

}  // namespace

Certificate CertificateOfMap(const map::ErrorMap& map, Eigen::Index count, Sense sense) {
  if (!map.StatesUncertainty()) {
    throw InputError(
        "the map states no uncertainty, and a certificate needs one: fuse or measure it anew");
  }
  if (count < 2) throw InputError(fmt::format("{} positions along an axis: give 2 or more", count));
  if (sense == Sense::kTool) RefuseOtherSenses(map);
  Certificate certificate;
  certificate.title = fmt::format("Geometric errors of {}", map.origin().machine);
  certificate.temperature = {map.origin().temperature};
  certificate.methods = {
      "one estimate of all runs (abbe), error = actual minus nominal, names as in ISO 230-1",
      fmt::format("chain {}; error motions stated at the point [{} {} {}] m with all axes at zero",
                  map.model().chain().Text(), map.origin().reference.x(),
                  map.origin().reference.y(), map.origin().reference.z()),
      "every error is zero at the first end of its travel; a straightness has no slope, which is "
      "its squareness"};
  for (int error = 0; error < kErrors; ++error) {
    const std::string axes = AxesOf(error);
    const auto has = [&](char axis) { return HasAxis(map, axis); };
    if (!std::all_of(axes.begin(), axes.end(), has)) continue;
    certificate.results.push_back(SeriesOf(map, error, count));
  }
  if (sense == Sense::kTool) {
    const auto tables = map::Tabulate(map, map.origin().tool, {count, count, count});
    for (const std::string& line : map::SignOfTables(tables)) certificate.methods.push_back(line);
    const Eigen::VectorXd u = UncertaintyOfTables(map, count);
    for (int error = 0; error < kMotionErrors; ++error) {
      Series& series = certificate.results[error];
      series.values = tables.errors[error].values;
      series.positions = tables.errors[error].positions;
      series.U95 = ListOf(standards::kCoverage * u.segment(error * count, count));
    }
  } else {
    certificate.methods.push_back(fmt::format(
        "errors of the carriages: {} (X, Y, Z count as); turns right-handed; C0Y turns the line of "
        "Y about +z, A0Z and B0Z that of Z about +x and +y",
        map.model().chain().PositiveText()));
    certificate.joint.push_back(JointOf(map));
  }
  if (!map.origin().scale_is_calibrated) {
    certificate.remarks.emplace_back(
        "The isotropic scale is that of the prior: no calibrated length was measured");
  }
  return certificate;
}

}  // namespace abbe::certificate
