#include "fusion/calibration.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <utility>

#include "failure/failure.h"
#include "fusion/mapping.h"
#include "relm/tip_path.h"
#include "simulation/linkage/linkage_problem.h"
#include "simulation/linkage/linkage_run.h"
#include "simulation/linkage/linkage_simulation.h"

namespace abbe::fusion {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kNegligible = 1e-9;  // m

}  // namespace

CalibratedLinkage::CalibratedLinkage(const relm::LinkageSettings& settings, Calibration calibration)
    : calibration_(std::move(calibration)),
      model_(relm::MakeLinkageModel(settings, calibration_.model)),
      nominal_X_MB_(settings.X_MB) {
  if (calibration_.mountings.empty()) throw InputError("calibration: has no mounting of the base");
  for (const std::string& mounting : calibration_.mountings) {
    x_.push_back(simulation::ParametersOf(calibration_.blocks, mounting));
    if (x_.back().size() != simulation::LinkageSimulation::kBase + model_.parameters()) {
      throw InputError(fmt::format(
          "calibration: {} parameters, but model \"{}\" of this machine file has {}; calibrate "
          "again with this machine file",
          x_.back().size() - simulation::LinkageSimulation::kBase, model_.name(),
          model_.parameters()));
    }
  }
}

std::size_t CalibratedLinkage::IndexOf(const std::string& mounting, bool strict) const {
  const auto& names = calibration_.mountings;
  const auto at = std::find(names.begin(), names.end(), mounting);
  if (at != names.end()) return at - names.begin();
  if (!strict) return 0;
  throw InputError(fmt::format(
      "calibration: knows no mounting \"{}\" of the base, only \"{}\"; calibrate with a recording "
      "of that mounting",
      mounting, fmt::join(names, "\", \"")));
}

geometry::Transform<double> CalibratedLinkage::X_MB(const std::string& mounting,
                                                    bool strict) const {
  return simulation::BaseAt(nominal_X_MB_, x_[IndexOf(mounting, strict)].head<6>());
}

Matrix3Xd CalibratedLinkage::Tips(const relm::LinkageReadings& readings,
                                  const std::string& mounting, bool strict) const {
  const VectorXd values = x_[IndexOf(mounting, strict)].tail(model_.parameters());
  const auto X_MB = this->X_MB(mounting, strict);
  if (calibration_.mapped) {
    return BlendedTips(model_, X_MB, values, *calibration_.mapped, readings);
  }
  Matrix3Xd p_BT;
  model_.Tips(readings, values, p_BT);
  return relm::InFrame(X_MB, p_BT);
}

MatrixXd CalibratedLinkage::JacobianByFree(const relm::LinkageReadings& readings,
                                           const std::string& mounting, bool strict) const {
  const std::size_t index = IndexOf(mounting, strict);
  const VectorXd& x = x_[index];
  const auto columns =
      simulation::ColumnsOf(calibration_.blocks, calibration_.mountings[index], calibration_.names);
  Matrix3Xd p_BT;
  estimation::RowMatrix J_tip_x, J;
  model_.Tips(readings, x.tail(model_.parameters()), p_BT, &J_tip_x);
  simulation::JacobianInMachine(nominal_X_MB_, x, p_BT, J_tip_x, J);
  MatrixXd J_free = MatrixXd::Zero(J.rows(), calibration_.covariance.cols());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i] >= 0) J_free.col(columns[i]) = J.col(i);
  }
  return J_free;
}

Matrix3Xd CalibratedLinkage::StandardUncertainties(const relm::LinkageReadings& readings,
                                                   const std::string& mounting) const {
  const MatrixXd J = JacobianByFree(readings, mounting, /*strict=*/true);
  const VectorXd variance = (J * calibration_.covariance).cwiseProduct(J).rowwise().sum();
  return variance.cwiseSqrt().reshaped(3, readings.poses());
}

std::vector<std::vector<Matrix3Xd>> CalibratedLinkage::IndependentErrors(
    const std::vector<const relm::LinkageReadings*>& readings,
    const std::vector<std::string>& mountings) const {
  // covariance = L L'; the eigenvectors V of L' (sum of J' J) L turn L into directions whose
  // effects on the tips are orthogonal: with L V instead of L the product stays the same.
  const Eigen::SelfAdjointEigenSolver<MatrixXd> root(calibration_.covariance);
  const MatrixXd L =
      root.eigenvectors() * root.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
  std::vector<MatrixXd> moved;
  MatrixXd squares = MatrixXd::Zero(L.cols(), L.cols());
  double poses = 0.0;
  for (std::size_t set = 0; set < readings.size(); ++set) {
    moved.emplace_back(JacobianByFree(*readings[set], mountings[set], /*strict=*/false) * L);
    squares += moved.back().transpose() * moved.back();
    poses += readings[set]->poses();
  }
  const Eigen::SelfAdjointEigenSolver<MatrixXd> turned(squares);
  std::vector<std::vector<Matrix3Xd>> errors;
  for (Index k = L.cols() - 1; k >= 0; --k) {
    if (turned.eigenvalues()[k] < kNegligible * kNegligible * poses) break;
    std::vector<Matrix3Xd>& direction = errors.emplace_back();
    for (const MatrixXd& one : moved) {
      direction.emplace_back((one * turned.eigenvectors().col(k)).reshaped(3, one.rows() / 3));
    }
  }
  return errors;
}

}  // namespace abbe::fusion
