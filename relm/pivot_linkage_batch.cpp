// The batch functions of the closed form: the same equations on blocks of poses, loops that the
// compiler turns into vector instructions.
#include <algorithm>
#include <cmath>

#include "relm/pivot_linkage.h"
#include "relm/vector_trigonometry.h"

namespace abbe::relm {
namespace {

constexpr int kBlock = 64;  // poses: all arrays of a block stay in the first-level cache
using Lane = double[kBlock];

void BlockTips(const double* __restrict__ q, int count, double link_1, double link_2,
               double* __restrict__ p) {
  alignas(32) Lane angle[3], s[3], c[3];
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) angle[k][i] = q[3 * i + k];
  }
  for (int k = 0; k < 3; ++k) SinesAndCosines(angle[k], count, s[k], c[k]);
  for (int i = 0; i < count; ++i) {
    const double a = link_1 + link_2 * s[2][i], b = link_2 * c[2][i];
    const double r = b * s[1][i] + a * c[1][i];
    p[3 * i] = c[0][i] * r;
    p[3 * i + 1] = s[0][i] * r;
    p[3 * i + 2] = b * c[1][i] - a * s[1][i];
  }
}

// sign: -1 for a branch that reaches over; elbow: the sign of cos q3. A pose without solution gets
// the angles of (y, x) = (0, 1): zero.
void BlockAngles(const double* __restrict__ p, const Reach* reach, int count, double link_1,
                 double link_2, double sign, double elbow, double* __restrict__ q) {
  alignas(32) Lane y[3], x[3], angle[3];
  const double squares = link_1 * link_1 + link_2 * link_2;
  const double inverse = 0.5 / (link_1 * link_2);
  for (int i = 0; i < count; ++i) {
    const double px = p[3 * i], py = p[3 * i + 1], z = p[3 * i + 2];
    const double square = px * px + py * py;
    const double r = sign * std::sqrt(square);
    const double sine = (square + z * z - squares) * inverse;
    const double cosine = elbow * std::sqrt(std::max(0.0, (1 - sine) * (1 + sine)));
    const double a = link_1 + link_2 * sine, b = link_2 * cosine;
    y[0][i] = sign * py;
    x[0][i] = sign * px;
    y[1][i] = b * r - a * z;
    x[1][i] = a * r + b * z;
    y[2][i] = sine;
    x[2][i] = cosine;
  }
  for (int i = 0; i < count; ++i) {
    if (reach[i] == Reach::kReached) continue;
    for (int k = 0; k < 3; ++k) y[k][i] = 0, x[k][i] = 1;
  }
  for (int k = 0; k < 3; ++k) ArcTangents(y[k], x[k], count, angle[k]);
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) q[3 * i + k] = angle[k][i];
  }
}

}  // namespace

void PivotLinkage::Tips(const Poses& angles, Eigen::Matrix3Xd& tips) const {
  tips.resize(3, angles.cols());
  for (Eigen::Index first = 0; first < angles.cols(); first += kBlock) {
    const int count = static_cast<int>(std::min<Eigen::Index>(kBlock, angles.cols() - first));
    BlockTips(angles.data() + 3 * first, count, link_1_, link_2_, tips.data() + 3 * first);
  }
}

Eigen::Index PivotLinkage::AnglesOf(const Poses& tips, const Branch& branch,
                                    Eigen::Matrix3Xd& angles, std::vector<Reach>& reach) const {
  angles.resize(3, tips.cols());
  reach.resize(tips.cols());
  const double sign = branch.reach_over ? -1 : 1;
  const double elbow = branch.elbow == Elbow::kUp ? -sign : sign;
  Eigen::Index reached = 0;
  for (Eigen::Index first = 0; first < tips.cols(); first += kBlock) {
    const int count = static_cast<int>(std::min<Eigen::Index>(kBlock, tips.cols() - first));
    Reach* const block = reach.data() + first;
    for (int i = 0; i < count; ++i) {
      block[i] = ReachOf(tips.col(first + i));
      reached += block[i] == Reach::kReached ? 1 : 0;
    }
    BlockAngles(tips.data() + 3 * first, block, count, link_1_, link_2_, sign, elbow,
                angles.data() + 3 * first);
  }
  return reached;
}

}  // namespace abbe::relm
