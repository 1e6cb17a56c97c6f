#include "probes/sweep_gauge.h"

namespace abbe::probes {

SweepGauge::SweepGauge(const Eigen::VectorXd& stations, Eigen::Index directions)
    : directions_(directions) {
  const Eigen::Index groups = stations.size() * directions;
  position_.resize(groups);
  for (Eigen::Index group = 0; group < groups; ++group) {
    position_[group] = stations[group / directions];
  }
  position_.array() -= stations.mean();
  slope_weights_ = position_ / position_.squaredNorm();
}

Eigen::MatrixXd SweepGauge::Apply(Kind kind, const Eigen::MatrixXd& values) const {
  if (kind == Kind::kFirstStation) {
    return values.rowwise() - values.topRows(directions_).colwise().mean();
  }
  return (values.rowwise() - values.colwise().mean()) -
         position_ * (slope_weights_.transpose() * values);
}

Eigen::MatrixXd SweepGauge::Covariance(Kind kind, const Eigen::MatrixXd& covariance) const {
  return Apply(kind, Apply(kind, covariance).transpose());
}

Eigen::MatrixXd SweepGauge::StationMeans(const Eigen::MatrixXd& values) const {
  Eigen::MatrixXd means = Eigen::MatrixXd::Zero(values.rows() / directions_, values.cols());
  for (Eigen::Index group = 0; group < values.rows(); ++group) {
    means.row(group / directions_) += values.row(group) / directions_;
  }
  return means;
}

}  // namespace abbe::probes
