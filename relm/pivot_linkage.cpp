#include "relm/pivot_linkage.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "failure/failure.h"

namespace abbe::relm {
namespace {

double Checked(double length, const char* name) {
  if (!std::isfinite(length) || length <= 0) {
    throw InputError(
        fmt::format("linkage: {} is {} mm; give a positive length", name, length * 1e3));
  }
  return length;
}

}  // namespace

PivotLinkage::PivotLinkage(double link_1, double link_2)
    : link_1_(Checked(link_1, "link_1")), link_2_(Checked(link_2, "link_2")) {}

Eigen::Vector3d PivotLinkage::Tip(const Eigen::Vector3d& q) const {
  const double c2 = std::cos(q[1]), s2 = std::sin(q[1]);
  const double a = link_1_ + link_2_ * std::sin(q[2]), b = link_2_ * std::cos(q[2]);
  const double r = b * s2 + a * c2;
  return {std::cos(q[0]) * r, std::sin(q[0]) * r, b * c2 - a * s2};
}

Eigen::Matrix3d PivotLinkage::JacobianTipAngles(const Eigen::Vector3d& q) const {
  const double c1 = std::cos(q[0]), s1 = std::sin(q[0]);
  const double c2 = std::cos(q[1]), s2 = std::sin(q[1]);
  const double a = link_1_ + link_2_ * std::sin(q[2]), b = link_2_ * std::cos(q[2]);
  const double r = b * s2 + a * c2, z = b * c2 - a * s2;
  const double r3 = link_2_ * std::cos(q[1] + q[2]), z3 = -link_2_ * std::sin(q[1] + q[2]);
  Eigen::Matrix3d J;
  J << -s1 * r, c1 * z, c1 * r3,  //
      c1 * r, s1 * z, s1 * r3,    //
      0, -r, z3;
  return J;
}

Reach PivotLinkage::ReachOf(const Eigen::Vector3d& p) const {
  const double distance = p.norm();
  const double sine =
      (distance * distance - link_1_ * link_1_ - link_2_ * link_2_) / (2 * link_1_ * link_2_);
  if (!(sine <= 1)) return Reach::kTooFar;
  if (sine < -1 || distance <= kSingular * (link_1_ + link_2_)) return Reach::kTooNear;
  if ((1 - sine) * (1 + sine) < kSingular * kSingular) return Reach::kStraight;
  if (std::hypot(p.x(), p.y()) < kSingular * (link_1_ + link_2_)) return Reach::kOnAxis;
  return Reach::kReached;
}

std::optional<Eigen::Vector3d> PivotLinkage::FindAngles(const Eigen::Vector3d& p,
                                                        const Branch& branch) const {
  if (ReachOf(p) != Reach::kReached) return std::nullopt;
  const double over = branch.reach_over ? -1 : 1;
  const double r = over * std::hypot(p.x(), p.y()), z = p.z();
  const double sine =
      (r * r + z * z - link_1_ * link_1_ - link_2_ * link_2_) / (2 * link_1_ * link_2_);
  const double cosine =
      (branch.elbow == Elbow::kUp ? -over : over) * std::sqrt((1 - sine) * (1 + sine));
  const double a = link_1_ + link_2_ * sine, b = link_2_ * cosine;
  return Eigen::Vector3d(std::atan2(over * p.y(), over * p.x()),
                         std::atan2(b * r - a * z, a * r + b * z), std::atan2(sine, cosine));
}

Eigen::Vector3d PivotLinkage::Angles(const Eigen::Vector3d& p, const Branch& branch) const {
  if (const auto angles = FindAngles(p, branch)) return *angles;
  const double mm = 1e3 * p.norm();
  switch (ReachOf(p)) {
    case Reach::kTooFar:
      throw NumericalError(
          fmt::format("linkage: the ball at ({:.3f}, {:.3f}, {:.3f}) mm is out of reach: {:.3f} mm "
                      "from pivot 2, "
                      "the links reach {:.3f} mm; move the base nearer",
                      1e3 * p.x(), 1e3 * p.y(), 1e3 * p.z(), mm, 1e3 * (link_1_ + link_2_)));
    case Reach::kTooNear:
      throw NumericalError(fmt::format(
          "linkage: the ball at ({:.3f}, {:.3f}, {:.3f}) mm is out of reach: {:.3f} mm from pivot "
          "2, "
          "the links fold to {:.3f} mm; move the base away",
          1e3 * p.x(), 1e3 * p.y(), 1e3 * p.z(), mm, 1e3 * std::abs(link_1_ - link_2_)));
    case Reach::kStraight:
      throw NumericalError(fmt::format(
          "linkage: singular with the ball {:.3f} mm from pivot 2: the links are in line and both "
          "elbows coincide; stay away from the edge of the workspace",
          mm));
    default:
      throw NumericalError(fmt::format(
          "linkage: singular with the ball on the axis of pivot 1 at z = {:.3f} mm: its angle is "
          "not determined; move the base sideways",
          1e3 * p.z()));
  }
}

Branch PivotLinkage::BranchOf(const Eigen::Vector3d& q) const {
  const double a = link_1_ + link_2_ * std::sin(q[2]), b = link_2_ * std::cos(q[2]);
  const bool over = b * std::sin(q[1]) + a * std::cos(q[1]) < 0;
  const bool up = (b < 0) != over;
  return {up ? Elbow::kUp : Elbow::kDown, over};
}

Eigen::VectorXd Unwrapped(const Eigen::VectorXd& angles, const Eigen::VectorXd& near) {
  constexpr double kTurn = 2 * std::numbers::pi;
  return (angles.array() - kTurn * ((angles - near).array() / kTurn).round()).matrix();
}

}  // namespace abbe::relm
