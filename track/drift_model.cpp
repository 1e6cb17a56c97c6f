#include "track/drift_model.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <array>
#include <cmath>

#include "failure/failure.h"
#include "fusion/machine_prior.h"
#include "map/error_map.h"

namespace abbe::track {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kPoints = 101;  // over a travel
constexpr std::array kSquarenesses{"A0Z", "B0Z", "C0Y"};

bool IsStraightness(int axis, int motion) { return motion < 3 && motion != axis; }

// The coefficients that make s^power over the travel; a straightness has no line in it.
VectorXd CoefficientsOfPower(const machine::ErrorFunction& function, const machine::Travel& travel,
                             int power, bool straightness) {
  MatrixXd J(kPoints, function.size());
  VectorXd values(kPoints), gradient(function.size());
  const double length = travel.last - travel.first;
  for (int i = 0; i < kPoints; ++i) {
    const double s = static_cast<double>(i) / (kPoints - 1);
    function.Evaluate(travel.first + s * length, nullptr, gradient.data());
    J.row(i) = gradient.transpose();
    values[i] = std::pow(s, power);
  }
  if (straightness) {  // the gauge leaves no line in it
    MatrixXd with_line(kPoints, function.size() + 2);
    with_line << J, VectorXd::Ones(kPoints), VectorXd::LinSpaced(kPoints, 0.0, 1.0);
    return with_line.completeOrthogonalDecomposition().solve(values).head(function.size());
  }
  return J.completeOrthogonalDecomposition().solve(values);
}

}  // namespace

MatrixXd WalkRoot(const machine::Machine& machine, const machine::VolumetricModel& model,
                  const machine::Population& walk) {
  machine::Machine walking = machine;
  walking.population = walk;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      const auto& form = model.Function(axis, motion).form();
      if (form == nullptr || (form->Name() == "b-spline" && form->Shape().at("degree")[0] == 5.0))
        continue;
      throw InputError(
          fmt::format("{} of the map is no spline of abbe fuse; only a fused map can be kept true",
                      machine::MotionName(axis, motion)));
    }
  }
  const fusion::MachinePrior prior(walking, model, fusion::PopulationOf(walking));
  const Index n = model.ParameterCount();
  MatrixXd root = MatrixXd::Zero(n, n);
  Index at = 0;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      const Index size = model.Function(axis, motion).size();
      const bool walks = machine::PopulationDeviation(walk, axis, motion) > 0.0 ||
                         (motion == axis && walk.scale > 0.0);
      if (size > 0 && walks) {
        const auto spread = prior.SpreadOf(axis, motion);
        root.block(at, at, size, size) = spread.axes * spread.deviations.asDiagonal();
      }
      at += size;
    }
  }
  root.diagonal().tail<3>().setConstant(walk.squareness);
  return root;
}

Response ResponseOf(const std::string& sensor, const machine::VolumetricModel& model,
                    const machine::Population& by_kelvin) {
  Response response;
  const Index n = model.ParameterCount();
  std::vector<VectorXd> columns;
  std::vector<double> deviations;
  const auto add = [&](std::string name, Index first, const VectorXd& coefficients, double sd) {
    response.names.push_back(std::move(name));
    columns.push_back(VectorXd::Zero(n));
    columns.back().segment(first, coefficients.size()) = coefficients;
    deviations.push_back(sd);
  };
  Index at = 0;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    const machine::Travel& travel = model.travels()[axis];
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      const auto& function = model.Function(axis, motion);
      if (function.size() == 0) continue;
      const std::string name =
          fmt::format("response {} {}", sensor, machine::MotionName(axis, motion));
      const double sd = machine::PopulationDeviation(by_kelvin, axis, motion);
      const bool straight = IsStraightness(axis, motion);
      const double growth = by_kelvin.scale * (travel.last - travel.first);
      const int first = straight ? 2 : 1;
      add(name + (straight ? ".quadratic" : ".linear"), at,
          CoefficientsOfPower(function, travel, first, straight), motion == axis ? growth : sd);
      add(name + (straight ? ".cubic" : ".quadratic"), at,
          CoefficientsOfPower(function, travel, first + 1, straight), sd);
      at += function.size();
    }
  }
  for (Index k = 0; k < 3; ++k) {
    add(fmt::format("response {}.{}", sensor, kSquarenesses[k]), n - 3 + k, VectorXd::Ones(1),
        by_kelvin.squareness);
  }
  const Index count = columns.size();
  response.shapes.resize(n, count);
  for (Index k = 0; k < count; ++k) response.shapes.col(k) = columns[k];
  response.deviations = Eigen::Map<const VectorXd>(deviations.data(), count);
  return response;
}

}  // namespace abbe::track
