#include "investigate/expected_information.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "random/counter_random.h"

namespace abbe::investigate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// The evidence of one world for any score.
class Judge {
 public:
  Judge(const World& world, const MatrixXd& S) {
    if (!world.candidate) return;
    const diagnosis::Candidate& candidate = *world.candidate;
    binary_ = candidate.cause->IsBinary();
    if (binary_) {
      constant_ = -0.5 * S(0, 0);
      return;
    }
    // What acts nowhere adds nothing to the evidence.
    for (Index i = 0; i < S.rows(); ++i) {
      if (S(i, i) != 0.0) acting_.push_back(i);
    }
    if (acting_.empty()) return;
    unit_ = candidate.Plausible()(acting_);
    const MatrixXd scaled = unit_.asDiagonal() * S(acting_, acting_) * unit_.asDiagonal();
    factor_.compute(scaled + MatrixXd::Identity(scaled.rows(), scaled.cols()));
    const double log_determinant = 2.0 * MatrixXd(factor_.matrixL()).diagonal().array().log().sum();
    constant_ = 0.5 * (factor_.solve(scaled).trace() - log_determinant);
  }

  double Evidence(const VectorXd& score) const {
    if (binary_) return score[0] + constant_;
    if (unit_.size() == 0) return 0.0;
    const VectorXd mean = unit_.cwiseProduct(score(acting_));
    return 0.5 * mean.dot(factor_.solve(mean)) + constant_;
  }

 private:
  bool binary_ = false;
  std::vector<Index> acting_;  // coefficients
  VectorXd unit_;              // of these
  // Computed at once: a factorisation without content must not be copied.
  Eigen::LLT<MatrixXd> factor_{MatrixXd::Identity(1, 1)};
  double constant_ = 0.0;
};

class Judges {
 public:
  Judges(const MatrixXd& S, const std::vector<World>& worlds) : S_(S) {
    Index first = 0;
    for (const World& world : worlds) {
      const Index count = world.mean.size();
      first_.push_back(first);
      count_.push_back(count);
      judges_.emplace_back(world, S.block(first, first, count, count));
      first += count;
    }
  }

  // Where `a` are the true coefficients of world `truth`.
  VectorXd EvidenceIf(std::size_t truth, const VectorXd& a) const {
    if (a.size() == 0) return Evidence(VectorXd::Zero(S_.rows()));
    return Evidence(S_.middleCols(first_[truth], count_[truth]) * a);
  }

  VectorXd Evidence(const VectorXd& score) const {
    VectorXd evidence(judges_.size());
    for (std::size_t i = 0; i < judges_.size(); ++i) {
      evidence[i] = judges_[i].Evidence(score.segment(first_[i], count_[i]));
    }
    return evidence;
  }

 private:
  const MatrixXd& S_;
  std::vector<Index> first_, count_;
  std::vector<Judge> judges_;
};

// Unit vector of a world's coefficients, always the same.
VectorXd DirectionOf(std::size_t world, Index count) {
  constexpr std::uint64_t kSeed = 1, kStream = 0x1E57;
  const random::CounterRandom random(kSeed, kStream + world);
  VectorXd direction(count);
  for (Index i = 0; i < count; ++i) direction[i] = random.Normal(i);
  return direction * std::sqrt(static_cast<double>(count)) / direction.norm();
}

}  // namespace

VectorXd ExpectedEvidence(const MatrixXd& S, const std::vector<World>& worlds,
                          const VectorXd& score) {
  return Judges(S, worlds).Evidence(score);
}

double ExpectedInformation(const MatrixXd& before, const MatrixXd& after,
                           const std::vector<World>& worlds) {
  constexpr std::array<double, 3> kSizes{0.21, 0.67, 1.38};  // quantiles 1/6, 1/2, 5/6 of |N|
  constexpr double kHardly = 1e-6;
  VectorXd now(worlds.size());
  for (std::size_t i = 0; i < worlds.size(); ++i) now[i] = worlds[i].probability;
  now /= now.sum();
  const Judges judges_before(before, worlds), judges_after(after, worlds);
  double expected = 0.0, weights = 0.0;
  for (std::size_t truth = 0; truth < worlds.size(); ++truth) {
    const World& world = worlds[truth];
    if (now[truth] < kHardly) continue;
    const Index count = world.mean.size();
    const VectorXd direction = count > 0 ? DirectionOf(truth, count) : VectorXd();
    for (const double size : kSizes) {
      const VectorXd a = world.mean + size * world.deviation.cwiseProduct(direction);
      const VectorXd growth =
          judges_after.EvidenceIf(truth, a) - judges_before.EvidenceIf(truth, a);
      VectorXd then = now.cwiseProduct((growth.array() - growth.maxCoeff()).exp().matrix());
      then /= then.sum();
      expected += now[truth] * EntropyOf(worlds, then);
      weights += now[truth];
    }
  }
  return EntropyOf(worlds, now) - expected / weights;
}

}  // namespace abbe::investigate
