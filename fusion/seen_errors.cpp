#include "fusion/seen_errors.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "fusion/marginal.h"
#include "map/error_map.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kHalf = 0.5;
constexpr Index kTravelStations = 25;  // over a travel, for variances

// The rows that give the values of one error over the travel; of a squareness itself.
MatrixXd ValuesOf(const machine::Machine& machine, const machine::VolumetricModel& model,
                  int error) {
  const Index n = model.ParameterCount();
  if (error >= machine::kAxes * machine::kMotions) {
    return Eigen::RowVectorXd::Unit(n, n - 3 + error - machine::kAxes * machine::kMotions);
  }
  const int axis = error / machine::kMotions, motion = error % machine::kMotions;
  Index first = 0;
  for (int e = 0; e < error; ++e) {
    first += model.Function(e / machine::kMotions, e % machine::kMotions).size();
  }
  const auto& function = model.Function(axis, motion);
  const auto& travel = machine.travels[axis];
  const VectorXd stations = VectorXd::LinSpaced(kTravelStations, travel.first, travel.last);
  MatrixXd rows = MatrixXd::Zero(kTravelStations, n);
  VectorXd gradient(function.size());
  for (Index i = 0; i < kTravelStations; ++i) {
    function.Evaluate(stations[i], nullptr, gradient.data());
    rows.row(i).segment(first, function.size()) = gradient.transpose();
  }
  return rows;
}

// The mean slope of EXX, EYY and EZZ over the axes of the machine.
Eigen::RowVectorXd ScaleRow(const machine::Machine& machine,
                            const machine::VolumetricModel& model) {
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(model.ParameterCount());
  int axes = 0;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    const auto& travel = machine.travels[axis];
    if (!(travel.last > travel.first)) continue;
    const VectorXd x = VectorXd::LinSpaced(kTravelStations, travel.first, travel.last);
    const VectorXd centred = x.array() - x.mean();
    row += centred.transpose() * ValuesOf(machine, model, machine::kMotions * axis + axis) /
           centred.squaredNorm();
    ++axes;
  }
  return row / axes;
}

// Mean variance of the rows of E.
double Variance(const MatrixXd& E, const MatrixXd& C) {
  return (E * C).cwiseProduct(E).sum() / E.rows();
}

}  // namespace

SeenErrors SeeErrors(const machine::Machine& machine, const machine::VolumetricModel& model,
                     const std::vector<simulation::SimulatedRun>& runs,
                     const std::vector<int>& columns, const estimation::Linearization& at) {
  const MatrixXd prior = at.prior.information + at.sources.back().information;
  MatrixXd all = prior;
  std::map<std::string, MatrixXd> kinds;
  for (std::size_t s = 0; s < runs.size(); ++s) {
    kinds.try_emplace(runs[s].kind, prior).first->second += at.sources[s].information;
    all += at.sources[s].information;
  }
  const MatrixXd C_prior = MarginalCovariance(prior, columns);
  SeenErrors seen{{}, {}, MarginalCovariance(all, columns)};
  std::map<std::string, MatrixXd> C_kinds;
  for (const auto& [kind, information] : kinds) {
    C_kinds[kind] = MarginalCovariance(information, columns);
  }
  for (int error = 0; error < map::kErrors; ++error) {
    const MatrixXd E = ValuesOf(machine, model, error);
    const double before = Variance(E, C_prior);
    FunctionSeen function{
        map::ErrorName(error), std::sqrt(before), std::sqrt(Variance(E, seen.covariance)), {}};
    std::vector<std::pair<double, std::string>> by;
    for (const auto& [kind, C] : C_kinds) {
      const double after = Variance(E, C);
      if (after < kHalf * before) by.emplace_back(after, kind);
    }
    std::sort(by.begin(), by.end());
    for (auto& [after, kind] : by) function.determined_by.push_back(kind);
    seen.functions.push_back(std::move(function));
  }
  const Eigen::RowVectorXd row = ScaleRow(machine, model);
  seen.scale.value = row.dot(model.Parameters());
  seen.scale.prior = std::sqrt(Variance(row, C_prior));
  seen.scale.u = std::sqrt(Variance(row, seen.covariance));
  seen.scale.calibrated = std::pow(seen.scale.u, 2) < kHalf * std::pow(seen.scale.prior, 2);
  return seen;
}

}  // namespace abbe::fusion
