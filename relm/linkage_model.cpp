#include "relm/linkage_model.h"

#include <fmt/format.h>

#include <utility>

#include "failure/failure.h"

namespace abbe::relm {

LinkageModel::LinkageModel(std::string name, MotionChain motions,
                           std::vector<estimation::ParameterBlock> blocks)
    : name_(std::move(name)), motions_(std::move(motions)), blocks_(std::move(blocks)) {
  Check(joints(), Values().size());
}

void LinkageModel::Check(Eigen::Index angles, Eigen::Index parameters) const {
  if (angles != joints()) {
    throw InputError(fmt::format("linkage: {} encoder angles for {} pivots", angles, joints()));
  }
  if (parameters != motions_.parameters()) {
    throw InputError(fmt::format("linkage: {} parameters for the {} of model {}", parameters,
                                 motions_.parameters(), name_));
  }
}

SerialChain LinkageModel::ChainAt(const Eigen::VectorXd& x) const {
  Check(joints(), x.size());
  return motions_.Moved(x.data());
}

Eigen::VectorXd LinkageModel::Values() const {
  std::vector<double> values;
  for (const auto& block : blocks_) {
    for (const auto& entry : block.entries) values.push_back(entry.value);
  }
  return Eigen::Map<Eigen::VectorXd>(values.data(), values.size());
}

std::vector<std::string> LinkageModel::Names() const {
  std::vector<std::string> names;
  for (const auto& block : blocks_) {
    for (std::size_t i = 0; i < block.entries.size(); ++i) names.push_back(block.FullName(i));
  }
  return names;
}

Eigen::Vector3d LinkageModel::Tip(const Eigen::VectorXd& angles, double warmth,
                                  const Eigen::VectorXd& x) const {
  Check(angles.size(), x.size());
  return motions_.Tip(angles.data(), warmth, x.data());
}

TipDerivatives LinkageModel::Differentiate(const Eigen::VectorXd& angles, double warmth,
                                           const Eigen::VectorXd& x) const {
  Check(angles.size(), x.size());
  TipDerivatives result{{}, RowMatrix(3, parameters()), RowMatrix(3, joints())};
  MotionChain::Workspace workspace;
  result.tip = motions_.Differentiate(angles.data(), warmth, x.data(), result.J_tip_x.data(),
                                      result.J_tip_q.data(), workspace);
  return result;
}

void LinkageModel::Tips(const LinkageReadings& readings, const Eigen::VectorXd& x,
                        Eigen::Matrix3Xd& tips, RowMatrix* jacobian) const {
  Check(readings.angles.rows(), x.size());
  if (readings.warmth.size() != 0 && readings.warmth.size() != readings.poses()) {
    throw InputError(fmt::format("linkage: {} temperatures for {} poses", readings.warmth.size(),
                                 readings.poses()));
  }
  tips.resize(3, readings.poses());
  if (jacobian != nullptr) jacobian->resize(3 * readings.poses(), parameters());
  MotionChain::Workspace workspace;
  for (Eigen::Index pose = 0; pose < readings.poses(); ++pose) {
    const double warmth = readings.warmth.size() == 0 ? 0.0 : readings.warmth[pose];
    double* const rows = jacobian == nullptr ? nullptr : jacobian->row(3 * pose).data();
    tips.col(pose) = motions_.Differentiate(readings.angles.col(pose).data(), warmth, x.data(),
                                            rows, nullptr, workspace);
  }
}

}  // namespace abbe::relm
