// Laws of the kinematics over random linkages and poses, and random junk.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

#include "failure/failure.h"
#include "linkage_by_matrices.h"
#include "relm/chain_inverse.h"
#include "relm/pivot_linkage.h"
#include "relm/serial_chain.h"

namespace abbe::relm {
namespace relm_property_test {

using Eigen::Index;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using Eigen::VectorXd;
constexpr double kEps = std::numeric_limits<double>::epsilon();

double In(double low, double high) {
  return low + (high - low) * *rc::gen::inRange(0, 1'000'000'001) / 1e9;
}
Vector3d VectorIn(double size) { return {In(-size, size), In(-size, size), In(-size, size)}; }
VectorXd AnglesOf(Index joints) {
  VectorXd q(joints);
  for (double& angle : q) angle = In(-3, 3);
  return q;
}
// Any of the 2^64 bit patterns: NaN, infinities, denormals, huge and tiny numbers.
double Junk() { return std::bit_cast<double>(*rc::gen::arbitrary<std::uint64_t>()); }
Vector3d JunkVector() {
  const auto any = [] { return *rc::gen::inRange(0, 3) == 0 ? Junk() : In(-0.3, 0.3); };
  return {any(), any(), any()};
}

PivotLinkage AnyLinkage() { return {In(0.02, 0.5), In(0.02, 0.5)}; }
Branch AnyBranch() {
  return {*rc::gen::element(Elbow::kUp, Elbow::kDown), *rc::gen::element(false, true)};
}

// Anywhere in the hollow sphere that the links reach: on each branch, forward after inverse is the
// ball again. sin q3 follows from the square of the distance, so a ball near pivot 2 loses
// reach / distance.
RC_GTEST_PROP(PivotLinkageProperty, ForwardAfterInverseIsTheBall, ()) {
  const PivotLinkage linkage = AnyLinkage();
  const double reach = linkage.link_1() + linkage.link_2();
  const double fold = std::abs(linkage.link_1() - linkage.link_2());
  const double distance = fold + (reach - fold) * In(0.0001, 0.9999);
  const Vector3d p = distance * VectorIn(1).normalized();
  RC_PRE(p.allFinite());
  for (const Branch branch : {Branch{Elbow::kUp, false}, Branch{Elbow::kDown, false},
                              Branch{Elbow::kUp, true}, Branch{Elbow::kDown, true}}) {
    const auto q = linkage.FindAngles(p, branch);
    RC_ASSERT(q.has_value() == (linkage.ReachOf(p) == Reach::kReached));
    if (!q) continue;
    RC_ASSERT((linkage.Tip(*q) - p).norm() < 64 * kEps * reach * (reach / distance));
    const Branch found = linkage.BranchOf(*q);
    RC_ASSERT(found.elbow == branch.elbow && found.reach_over == branch.reach_over);
    // The elbow by geometry: above or below the line from pivot 2 to the ball.
    const Vector3d elbow = (TurnZ((*q)[0]) * TurnY((*q)[1])).col(0).head<3>() * linkage.link_1();
    const Vector3d up = Vector3d::UnitZ() - p * p.z() / p.squaredNorm();
    RC_ASSERT((elbow.dot(up) > 0) == (branch.elbow == Elbow::kUp));
    // q1 points to the ball or, reaching over, away from it.
    RC_ASSERT((std::cos((*q)[0]) * p.x() + std::sin((*q)[0]) * p.y() < 0) == branch.reach_over);
  }
}

// sin q3 is known to a few eps / (L1 L2 / reach^2), q3 the worse the nearer to an edge; q1 the
// worse the nearer to the axis.
RC_GTEST_PROP(PivotLinkageProperty, InverseAfterForwardIsTheAngles, ()) {
  const PivotLinkage linkage = AnyLinkage();
  const Vector3d q = AnglesOf(3);
  const Vector3d p = linkage.Tip(q);
  const double reach = linkage.link_1() + linkage.link_2();
  const double across = std::hypot(p.x(), p.y()) / reach;
  const double shape = linkage.link_1() * linkage.link_2() / (reach * reach);
  RC_PRE(std::abs(std::cos(q[2])) > 1e-3 && across > 1e-3);
  const Vector3d found = linkage.Angles(p, linkage.BranchOf(q));
  const double worst = (Unwrapped(found, q) - q).cwiseAbs().maxCoeff();
  RC_ASSERT(worst < 64 * kEps / (shape * std::abs(std::cos(q[2])) * across * across));
}

RC_GTEST_PROP(PivotLinkageProperty, JunkGivesAnglesOrAnErrorNeverNaN, ()) {
  const PivotLinkage linkage = AnyLinkage();
  const Branch branch = AnyBranch();
  Eigen::Matrix3Xd junk(3, 70), angles;
  for (Index i = 0; i < junk.cols(); ++i) junk.col(i) = JunkVector();
  std::vector<Reach> reach;
  linkage.AnglesOf(junk, branch, angles, reach);
  RC_ASSERT(angles.allFinite());
  for (Index i = 0; i < junk.cols(); ++i) {
    const auto found = linkage.FindAngles(junk.col(i), branch);
    RC_ASSERT(found.has_value() == (reach[static_cast<std::size_t>(i)] == Reach::kReached));
    if (found) {
      RC_ASSERT(found->allFinite());
      RC_ASSERT((linkage.Tip(*found) - junk.col(i)).norm() < 1e-9);
    } else {
      RC_ASSERT_THROWS_AS(linkage.Angles(junk.col(i), branch), NumericalError);
    }
  }
}

SerialChain AnyChain(int joints) {
  std::vector<JointAxis> axes(joints);
  for (JointAxis& axis : axes) axis = {VectorIn(0.3), VectorIn(1) + 1.5 * Vector3d::UnitZ()};
  return SerialChain(axes, VectorIn(0.3));
}

// exp([s] q) of the twist s = (w, -w x point), as a matrix exponential of 4 x 4.
Matrix4d Exponential(const JointAxis& axis, double angle) {
  Matrix4d s = Matrix4d::Zero();
  const Vector3d w = axis.direction, v = -w.cross(axis.point);
  s.topLeftCorner<3, 3>() << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  s.topRightCorner<3, 1>() = v;
  return (s * angle).exp();
}

RC_GTEST_PROP(SerialChainProperty, IsTheProductOfExponentials, ()) {
  const SerialChain chain = AnyChain(*rc::gen::inRange(1, 7));
  const VectorXd q = AnglesOf(chain.joints());
  Matrix4d X = Matrix4d::Identity();
  for (Index i = 0; i < chain.joints(); ++i) {
    X *= Exponential(chain.axes()[static_cast<std::size_t>(i)], q[i]);
  }
  const Vector3d expected = (X * chain.tip().homogeneous()).head<3>();
  RC_ASSERT((chain.Tip(q) - expected).norm() < 1e-13);  // Pade of order 13: a few hundred roundings
  RC_ASSERT((expected - chain.axes()[0].point).norm() < chain.Reach() + 1e-13);
}

// Central differences of h = 1e-5 err by h^2/6 x reach = 2e-11 and by rounding / h = 1e-11.
RC_GTEST_PROP(SerialChainProperty, HasTheDerivativesOfDifferences, ()) {
  const SerialChain chain = AnyChain(*rc::gen::inRange(1, 7));
  const VectorXd q = AnglesOf(chain.joints());
  const Eigen::Matrix3Xd J = chain.JacobianTipAngles(q);
  constexpr double kStep = 1e-5;
  for (Index i = 0; i < q.size(); ++i) {
    const VectorXd e = kStep * VectorXd::Unit(q.size(), i);
    const Vector3d slope = (chain.Tip(VectorXd(q + e)) - chain.Tip(VectorXd(q - e))) / (2 * kStep);
    RC_ASSERT((J.col(i) - slope).norm() < 1e-9);
  }
}

RC_GTEST_PROP(SerialChainProperty, OfDenavitHartenbergRowsIsTheirProduct, ()) {
  std::vector<DenavitHartenbergRow> rows;
  Matrix4d X = Matrix4d::Identity();
  std::vector<double> q;
  for (int i = *rc::gen::inRange(0, 5); i >= 0; --i) {
    DenavitHartenbergRow row{In(-3, 3), In(-0.2, 0.2), In(-0.2, 0.2), In(-3, 3), i % 3 == 2};
    if (!row.fixed) q.push_back(In(-3, 3));
    X *= TurnZ(row.theta + (row.fixed ? 0.0 : q.back())) * MoveBy(0.0, 0.0, row.d) *
         MoveBy(row.a, 0.0, 0.0) * TurnX(row.alpha);
    rows.push_back(row);
  }
  const Vector3d p_nT = VectorIn(0.1);
  const SerialChain chain = SerialChain::FromDenavitHartenberg(rows, {}, p_nT);
  const Vector3d found = chain.Tip(Eigen::Map<VectorXd>(q.data(), static_cast<Index>(q.size())));
  RC_ASSERT((found - (X * p_nT.homogeneous()).head<3>()).norm() < 64 * kEps * 2);
}

// P = S0 (R0 + S1 (R1 + ... S5 R5)), S = Rz(theta) Ry(phi), R = (0, 0, L), as Boelens prints it.
RC_GTEST_PROP(SerialChainProperty, OfSegmentsIsTheDisplacementEquation, ()) {
  std::vector<Segment> segments;
  std::vector<SegmentConstants<double>> constants;
  Matrix4d X = Matrix4d::Identity();
  std::vector<double> q;
  for (int i = 0; i < 6; ++i) {
    const auto encoder = i == 0 ? SegmentEncoder::kTheta
                                : *rc::gen::element(SegmentEncoder::kNone, SegmentEncoder::kTheta,
                                                    SegmentEncoder::kPhi);
    const Segment segment{In(0, 0.2), In(-3, 3), In(-3, 3), encoder};
    double theta = segment.theta, phi = segment.phi;
    if (encoder != SegmentEncoder::kNone) q.push_back(In(-3, 3));
    if (encoder == SegmentEncoder::kTheta) theta += q.back();
    if (encoder == SegmentEncoder::kPhi) phi += q.back();
    X *= TurnZ(theta) * TurnY(phi) * MoveBy(0.0, 0.0, segment.length);
    segments.push_back(segment);
    constants.push_back({segment.length, theta, phi});
  }
  const Vector3d printed = PositionOf(X);
  RC_ASSERT((SegmentTip(constants) - printed).norm() < 64 * kEps);
  const VectorXd angles = Eigen::Map<VectorXd>(q.data(), static_cast<Index>(q.size()));
  RC_ASSERT((SerialChain::FromSegments(segments).Tip(angles) - printed).norm() < 64 * kEps * 2);
}

// The three ways to write the shipped linkage, and its closed form.
RC_GTEST_PROP(SerialChainProperty, IsTheSameByEveryFormOfTheSameLinkage, ()) {
  const double L1 = In(0.02, 0.5), L2 = In(0.02, 0.5), right = std::numbers::pi / 2;
  const SerialChain segments = SerialChain::FromSegments({{.encoder = SegmentEncoder::kTheta},
                                                          {.phi = right},
                                                          {L1, 0, 0, SegmentEncoder::kPhi},
                                                          {.phi = -right},
                                                          {L2, 0, 0, SegmentEncoder::kPhi}});
  // Rx(-90 deg) lays z along y; link 2 stands 90 deg above link 1.
  const SerialChain rows = SerialChain::FromDenavitHartenberg(
      {{.alpha = -right}, {.a = L1}, {.theta = -right, .a = L2}});
  const Vector3d o = Vector3d::Zero(), y = Vector3d::UnitY();
  const SerialChain axes({{o, Vector3d::UnitZ()}, {o, y}, {Vector3d(L1, 0, 0), y}},
                         Vector3d(L1, 0, L2));
  const VectorXd q = AnglesOf(3);
  const Vector3d p = PivotLinkage(L1, L2).Tip(q);
  for (const SerialChain* chain : {&segments, &rows, &axes}) {
    RC_ASSERT((chain->Tip(q) - p).norm() < 64 * kEps);
  }
}

// An arm of three to five pivots with errors of manufacture far beyond any tolerance.
SerialChain AnyArm() {
  const double right = std::numbers::pi / 2;
  const auto skew = [] { return In(-0.2, 0.2); };
  std::vector<Segment> segments = {
      {In(0, 0.1), skew(), skew(), SegmentEncoder::kTheta}, {In(0, 0.1), skew(), right + skew()},
      {In(0.1, 0.3), skew(), skew(), SegmentEncoder::kPhi}, {In(0, 0.02), skew(), -right + skew()},
      {In(0.1, 0.3), skew(), skew(), SegmentEncoder::kPhi},
  };
  for (int i = *rc::gen::inRange(0, 3); i > 0; --i) {
    segments.push_back(
        {In(0, 0.1), skew(), 0.5 + skew(), i == 1 ? SegmentEncoder::kTheta : SegmentEncoder::kPhi});
  }
  return SerialChain::FromSegments(segments);
}

// A start within 0.2 rad of a pose finds angles for it, where the pose is not nearly singular.
RC_GTEST_PROP(ChainInverseProperty, ForwardAfterInverseIsTheBall, ()) {
  const SerialChain chain = AnyArm();
  VectorXd q = AnglesOf(chain.joints());
  q[2] /= 3;  // bent
  const Eigen::MatrixXd J = chain.JacobianTipAngles(q);
  const VectorXd singular_values = J.jacobiSvd().singularValues();
  RC_PRE(singular_values[2] > 0.03 * chain.Reach());
  VectorXd near = q;
  for (double& angle : near) angle += In(-0.2, 0.2);
  const Vector3d p = chain.Tip(q);
  const VectorXd found = ChainInverse(chain).Angles(p, near);
  RC_ASSERT((chain.Tip(found) - p).norm() < 1e-11 * chain.Reach());
}

RC_GTEST_PROP(ChainInverseProperty, JunkGivesAnglesOrAnErrorNeverNaN, ()) {
  const SerialChain chain = AnyChain(3);
  const ChainInverse inverse(chain);
  const Vector3d p = JunkVector(), near = *rc::gen::inRange(0, 2) == 0 ? JunkVector() : VectorIn(3);
  if (const auto found = inverse.Find(p, near)) {
    RC_ASSERT(found->allFinite());
    RC_ASSERT((chain.Tip(*found) - p).norm() < 1e-11 * chain.Reach());
  } else {
    RC_ASSERT_THROWS_AS(inverse.Angles(p, near), NumericalError);
  }
}

}  // namespace relm_property_test
}  // namespace abbe::relm
