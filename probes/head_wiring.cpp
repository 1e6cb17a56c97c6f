#include "probes/head_wiring.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "settings/unit.h"

namespace abbe::probes {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Kind = Wiring::Kind;

constexpr double kFaceTilt = 10e-3;       // rad
constexpr double kTurnShare = 0.1;        // of a prescribed turn
constexpr double kTurnError = 1 / 36.0;   // turns
constexpr double kAngularMotion = 50e-6;  // rad, of the axis
constexpr double kGain = 0.01;
constexpr double kUnmovedSpread = 1e-6;       // m, of a channel that shows something else
constexpr double kReadingError = 0.2e-6;      // m
constexpr double kNamed = 8.0, kRival = 3.0;  // of the logarithm of the likelihood

std::vector<Wiring> AllWirings() {
  std::vector<Wiring> all = {{Kind::kRight, {}}};
  for (std::size_t i = 0; i < kProbes; ++i) {
    all.push_back({Kind::kInverted, {i}});
    all.push_back({Kind::kUnmoved, {i}});
    for (std::size_t k = i + 1; k < kProbes; ++k) all.push_back({Kind::kSwapped, {i, k}});
  }
  all.push_back({Kind::kInverted, {0, 1, 2}});
  all.push_back({Kind::kInverted, {3, 4}});
  all.push_back({Kind::kInverted, {0, 1, 2, 3, 4}});
  return all;
}

// The distribution of all readings, rightly wired: reading r * kProbes + i is that of probe i.
struct Expected {
  VectorXd mean;
  MatrixXd covariance;
};

class Expectation {
 public:
  Expectation(std::span<const GapsAt> readings, std::span<const std::vector<ScrewTurn>> turned,
              const HeadAligner& aligner)
      : readings_(readings), aligner_(aligner) {
    for (const GapsAt& at : readings) response_.push_back(aligner.screws().At(at.travel));
    for (const auto& turns : turned) {
      moved_.push_back(aligner.ScrewedBy(turns));
      deviation_.push_back(VectorXd::Zero(moved_.back().size()));
      for (const ScrewTurn& turn : turns) {
        deviation_.back()[static_cast<Index>(turn.screw)] =
            std::hypot(kTurnShare * turn.turns, kTurnError) *
            aligner.settings().screws[turn.screw].pitch;
      }
    }
  }

  Expected All() const {
    const auto rows = static_cast<Index>(readings_.size() * kProbes);
    Expected all{VectorXd(rows), MatrixXd::Zero(rows, rows)};
    for (Index row = 0; row < rows; ++row) {
      all.mean[row] = Mean(row);
      for (Index column = 0; column <= row; ++column) {
        all.covariance(row, column) = all.covariance(column, row) = Covariance(row, column);
      }
    }
    return all;
  }

 private:
  static std::size_t ProbeOf(Index row) { return static_cast<std::size_t>(row) % kProbes; }
  static std::size_t PlaceOf(Index row) { return static_cast<std::size_t>(row) / kProbes; }
  const GapsAt& At(Index row) const { return readings_[PlaceOf(row)]; }

  double Prescribed(Index row) const {
    double change = 0.0;
    for (int setting = 0; setting < At(row).setting; ++setting) {
      change += response_[PlaceOf(row)]
                    .row(static_cast<Index>(ProbeOf(row)))
                    .dot(moved_[static_cast<std::size_t>(setting)]);
    }
    return change;
  }

  double Mean(Index row) const { return 0.5 * aligner_.ranges()[ProbeOf(row)] + Prescribed(row); }

  double Covariance(Index a, Index b) const {
    const std::size_t i = ProbeOf(a), k = ProbeOf(b);
    const bool same_face = (i < kTopProbes) == (k < kTopProbes);
    double sum = 0.0;
    if (i == k) sum += std::pow(aligner_.ranges()[i], 2);
    if (same_face) sum += std::pow(kFaceTilt, 2) * At(a).travel * At(b).travel;
    for (int setting = 0; setting < std::min(At(a).setting, At(b).setting); ++setting) {
      const VectorXd& deviation = deviation_[static_cast<std::size_t>(setting)];
      sum += response_[PlaceOf(a)]
                 .row(static_cast<Index>(i))
                 .cwiseProduct(deviation.transpose())
                 .dot(response_[PlaceOf(b)]
                          .row(static_cast<Index>(k))
                          .cwiseProduct(deviation.transpose()));
    }
    if (PlaceOf(a) != PlaceOf(b)) return sum;
    const auto of_axis = aligner_.screws().OfTarget(0.0);
    const auto row = of_axis.row(static_cast<Index>(i)), other = of_axis.row(static_cast<Index>(k));
    sum += std::pow(aligner_.settings().motion, 2) * row.head<3>().dot(other.head<3>()) +
           std::pow(kAngularMotion, 2) * row.tail<3>().dot(other.tail<3>());
    if (i == k) sum += std::pow(kReadingError, 2) + std::pow(kGain * Prescribed(a), 2);
    return sum;
  }

  std::span<const GapsAt> readings_;
  const HeadAligner& aligner_;
  std::vector<ScrewResponse> response_;
  std::vector<VectorXd> moved_, deviation_;  // for each change of the setting
};

// What the channels show of it under a wiring.
Expected Shown(const Expected& right, const Wiring& wiring, const PerProbe<>& ranges) {
  const Index rows = right.mean.size();
  MatrixXd to_channels = MatrixXd::Identity(rows, rows);
  VectorXd offset = VectorXd::Zero(rows);
  for (Index first = 0; first < rows; first += static_cast<Index>(kProbes)) {
    const auto row = [&](std::size_t probe) { return first + static_cast<Index>(probe); };
    if (wiring.kind == Kind::kSwapped) {
      to_channels.row(row(wiring.probes[0])).swap(to_channels.row(row(wiring.probes[1])));
    }
    for (const std::size_t probe : wiring.probes) {
      if (wiring.kind == Kind::kInverted) {
        to_channels(row(probe), row(probe)) = -1.0;
        offset[row(probe)] = ranges[probe];
      }
      if (wiring.kind == Kind::kUnmoved) {
        to_channels(row(probe), row(probe)) = 0.0;
        offset[row(probe)] = 0.5 * ranges[probe];
      }
    }
  }
  Expected shown{to_channels * right.mean + offset,
                 to_channels * right.covariance * to_channels.transpose()};
  if (wiring.kind != Kind::kUnmoved) return shown;
  for (Index row = static_cast<Index>(wiring.probes[0]); row < rows;
       row += static_cast<Index>(kProbes)) {
    for (Index column = static_cast<Index>(wiring.probes[0]); column < rows;
         column += static_cast<Index>(kProbes)) {
      shown.covariance(row, column) = std::pow(ranges[wiring.probes[0]], 2) +
                                      (row == column ? std::pow(kUnmovedSpread, 2) : 0.0);
    }
  }
  return shown;
}

double LogLikelihood(const Expected& shown, const VectorXd& gaps) {
  const Eigen::LLT<MatrixXd> factor(shown.covariance);
  const VectorXd scaled = factor.matrixL().solve(gaps - shown.mean);
  return -0.5 * scaled.squaredNorm() - VectorXd(factor.matrixLLT().diagonal()).array().log().sum();
}

std::string ProbeNames(const std::vector<std::size_t>& probes) {
  std::string names;
  for (std::size_t i = 0; i < probes.size(); ++i) {
    names += i == 0 ? "" : i + 1 == probes.size() ? " and " : ", ";
    names += fmt::format("probe_{:c}", 'a' + probes[i]);
  }
  return names;
}

}  // namespace

std::string NameOf(const Wiring& wiring) {
  const std::string probes = ProbeNames(wiring.probes);
  const bool one = wiring.probes.size() == 1;
  switch (wiring.kind) {
    case Kind::kRight:
      return "the channels are wired as the machine file says";
    case Kind::kSwapped:
      return fmt::format("{} are swapped", probes);
    case Kind::kInverted:
      return fmt::format("the sign{} of {} {} wrong", one ? "" : "s", probes, one ? "is" : "are");
    case Kind::kUnmoved:
      return fmt::format("{} does not move with the target", probes);
  }
  return {};
}

WiringFinding FindWiring(std::span<const GapsAt> readings,
                         std::span<const std::vector<ScrewTurn>> turned,
                         const HeadAligner& aligner) {
  std::vector<GapsAt> whole;
  for (const GapsAt& at : readings) {
    if (std::ranges::none_of(at.gap, [](double gap) { return std::isnan(gap); })) {
      whole.push_back(at);
    }
  }
  if (whole.size() < 2) return {};
  const Expected right = Expectation(whole, turned, aligner).All();
  VectorXd gaps(right.mean.size());
  for (Index row = 0; row < gaps.size(); ++row) {
    gaps[row] =
        whole[static_cast<std::size_t>(row) / kProbes].gap[static_cast<std::size_t>(row) % kProbes];
  }
  struct Scored {
    Wiring wiring;
    double likelihood;
  };
  std::vector<Scored> scored;
  for (const Wiring& wiring : AllWirings()) {
    scored.push_back({wiring, LogLikelihood(Shown(right, wiring, aligner.ranges()), gaps)});
  }
  const double of_right = scored.front().likelihood;
  std::ranges::stable_sort(scored, std::greater<>(), &Scored::likelihood);
  WiringFinding finding;
  if (scored.front().likelihood < of_right + kNamed) {
    for (const Scored& one : scored) {
      const bool right_one = one.wiring.kind == Kind::kRight;
      if (!right_one && one.likelihood > of_right - kRival) finding.open.push_back(one.wiring);
    }
    return finding;
  }
  for (const Scored& one : scored) {
    if (one.likelihood > scored.front().likelihood - kRival) finding.wrong.push_back(one.wiring);
  }
  return finding;
}

std::optional<ScrewTurn> TestTurn(std::span<const Wiring> rivals, const GapsAt& at,
                                  const HeadAligner& aligner) {
  constexpr double kOfRange = 0.1;
  const ScrewResponse response = aligner.screws().At(at.travel);
  std::optional<ScrewTurn> best;
  double most = 0.0;
  for (std::size_t k = 0; k < aligner.settings().screws.size(); ++k) {
    const double pitch = aligner.settings().screws[k].pitch;
    const auto column = response.col(static_cast<Index>(k));
    double sum = 0.0, towards = 0.0;
    for (const Wiring& rival : rivals) {
      for (const std::size_t probe : rival.probes) {
        const double effect = column[static_cast<Index>(probe)];
        sum += std::pow(pitch * effect, 2);
        towards += effect * (0.5 * aligner.ranges()[probe] - at.gap[probe]);
      }
    }
    if (sum <= most) continue;
    most = sum;
    const double least_range = *std::ranges::min_element(aligner.ranges());
    const double turns = kOfRange * least_range / (pitch * column.cwiseAbs().maxCoeff());
    best = ScrewTurn{
        k, std::copysign(std::max(kFinestTurn, std::round(turns / kFinestTurn) * kFinestTurn),
                         towards)};
  }
  return best;
}

}  // namespace abbe::probes
