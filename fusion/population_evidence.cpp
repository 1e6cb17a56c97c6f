#include "fusion/population_evidence.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "estimation/in_parallel.h"
#include "failure/interruption.h"
#include "settings/unit.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Standard deviations of theta: what all sizes and what all lengths share, and what each has of its
// own.
constexpr double kCommonSize = 0.57, kOwnSize = 0.4;
constexpr double kCommonLength = 0.65, kOwnLength = 0.25;
constexpr double kWaveSize = 1.4, kWaveTo = 0.7;  // of waves
constexpr double kNoWave = 1e-3;                  // of a usual one
constexpr double kHardlyMoves = 4e-4;  // deviation, of the largest of a function: taken as 0
constexpr std::array kCommonLengths{0.25, 0.35, 0.5, 0.71, 1.0, 1.41, 2.0, 2.83, 4.0};
constexpr double kLongestStep = 0.7;
constexpr double kGainSettled = 0.01;  // of log Z
constexpr int kSteps = 12;
// Standard deviations: of a logarithm above, and below, where that of a size of a few degrees of
// freedom scatters further.
constexpr double kRefutedAbove = 3.5, kRefutedBelow = 5.0;
constexpr double kTold = 0.5;  // u of a logarithm, at most
const double kHardlyOff = std::log(1.33);

Line LineOf(int axis, int motion) {
  if (motion < 3) return motion == axis ? kPositioning : kStraightness;
  if (motion - 3 == axis) return kRoll;
  return motion - 3 == (axis == 1 ? 0 : 1) ? kPitch : kYaw;
}

}  // namespace

bool Statement::Refuted() const {
  const double off = std::log(seen / stated);
  const double bound = (off > 0.0 ? kRefutedAbove : kRefutedBelow) * u_log;
  return u_log < kTold && std::abs(off) > std::max(kHardlyOff, bound);
}

const std::array<LineInFile, kLines>& LinesInFile() {
  using settings::kMicro;
  using P = machine::Population;
  static constexpr std::array<LineInFile, kLines> kAll{
      {{"population.positioning_um", kMicro, &P::positioning},
       {"population.straightness_um", kMicro, &P::straightness},
       {"population.roll_urad", kMicro, &P::roll},
       {"population.pitch_urad", kMicro, &P::pitch},
       {"population.yaw_urad", kMicro, &P::yaw},
       {"population.squareness_urad", kMicro, &P::squareness},
       {"population.scale_ppm", kMicro, &P::scale},
       {kSmoothnessKey, settings::kMillimetre, &P::smoothness}}};
  return kAll;
}

Quadratic Marginalised(const Quadratic& all, const std::vector<int>& of_machine) {
  std::vector<bool> is_machine(all.vector.size(), false);
  for (const int column : of_machine) is_machine[column] = true;
  std::vector<int> others;
  for (int i = 0; i < all.vector.size(); ++i) {
    if (!is_machine[i] && all.information(i, i) > 0.0) others.push_back(i);
  }
  const VectorXd scale = all.information.diagonal()(others).cwiseSqrt().cwiseInverse();
  MatrixXd inner = scale.asDiagonal() * all.information(others, others) * scale.asDiagonal();
  inner.diagonal().array() += 1e-12;  // rounding
  const MatrixXd cross = scale.asDiagonal() * all.information(others, of_machine);
  const VectorXd right = scale.asDiagonal() * all.vector(others);
  const Eigen::LLT<MatrixXd> factor(inner);
  const MatrixXd half = factor.matrixL().solve(cross);
  const VectorXd left = factor.matrixL().solve(right);
  const double log = 0.5 * left.squaredNorm() - factor.matrixLLT().diagonal().array().log().sum() +
                     scale.array().log().sum();
  return {all.information(of_machine, of_machine) - half.transpose() * half,
          all.vector(of_machine) - half.transpose() * left, log};
}

PopulationEvidence::PopulationEvidence(const machine::Machine& machine,
                                       const machine::VolumetricModel& model)
    : machine_(machine), model_(model), stated_(machine, model, PopulationOf(machine)) {
  Index first = 0;
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      first_[axis][motion] = first;
      first += model.Function(axis, motion).size();
      if (model.Function(axis, motion).size() == 0) continue;
      knobs_.push_back({LineOf(axis, motion), axis, motion});
      knobs_.push_back({kSmoothness, axis, motion});
    }
  }
  squareness_ = first;
  knobs_.push_back({kSquareness, -1, -1});
  knobs_.push_back({kScale, -1, -1});
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    if (!HoldsWaves(model, axis)) continue;
    knobs_.push_back({kWave, axis, axis});
    knobs_.push_back({kWaveLength, axis, axis});
    waves_ += 2;
  }
  MatrixXd cov = MatrixXd::Zero(count(), count());
  for (Index i = 0; i < count(); ++i) {
    if (i >= count() - waves_) {
      cov(i, i) = std::pow(knobs_[i].line == kWave ? kWaveSize : kWaveTo, 2);
      continue;
    }
    for (Index j = 0; j < count() - waves_; ++j) {
      const bool length = IsLength(i);
      if (length == IsLength(j)) cov(i, j) = std::pow(length ? kCommonLength : kCommonSize, 2);
    }
    cov(i, i) += std::pow(IsLength(i) ? kOwnLength : kOwnSize, 2);
  }
  pi_ = cov.inverse();
}

ErrorPopulation PopulationEvidence::PopulationAt(const VectorXd& theta) const {
  ErrorPopulation population = PopulationOf(machine_);
  for (std::size_t i = 0; i < knobs_.size(); ++i) {
    const auto [line, axis, motion] = knobs_[i];
    const double factor = std::exp(theta[i]);
    if (line == kSquareness)
      population.squareness *= factor;
    else if (line == kWave)
      population.wave[axis] = kUsualWave * factor;
    else if (line == kWaveLength)
      population.wave_length[axis] = kUsualWaveLength * factor;
    else if (line == kScale)
      population.scale *= factor;
    else if (line == kSmoothness)
      population.length(axis, motion) *= factor;
    else
      population.deviation(axis, motion) *= factor;
  }
  return population;
}

MatrixXd PopulationEvidence::FactorAt(const VectorXd& theta) const {
  const ErrorPopulation population = PopulationAt(theta);
  const MachinePrior prior = stated_.With(population);
  const Index n = squareness_ + 3;
  MatrixXd L = MatrixXd::Zero(n, n);
  estimation::InParallel(machine::kAxes * machine::kMotions, [&](std::size_t function) {
    const int axis = static_cast<int>(function) / machine::kMotions,
              motion = static_cast<int>(function) % machine::kMotions;
    const Index size = model_.Function(axis, motion).size(), at = first_[axis][motion];
    if (size == 0) return;
    const auto spread = prior.SpreadOf(axis, motion);
    const double least = kHardlyMoves * spread.deviations.maxCoeff();
    const VectorXd deviations = (spread.deviations.array() < least).select(0.0, spread.deviations);
    L.block(at, at, size, size) = spread.axes * deviations.asDiagonal();
  });
  L.diagonal().tail<3>().setConstant(population.squareness);
  return L;
}

PopulationEvidence::Evidence PopulationEvidence::At(const Quadratic& of_machine,
                                                    const VectorXd& theta) const {
  const MatrixXd L = FactorAt(theta);
  MatrixXd HL(L.rows(), L.cols()), B(L.cols(), L.cols());
  EachBlock([&](Index at, Index size) {
    HL.middleCols(at, size).noalias() =
        of_machine.information.middleCols(at, size) * L.block(at, at, size, size);
  });
  EachBlock([&](Index at, Index size) {
    B.middleRows(at, size).noalias() =
        L.block(at, at, size, size).transpose() * HL.middleRows(at, size);
  });
  B.diagonal().array() += 1.0;
  std::vector<Index> allowed;
  for (Index column = 0; column < L.cols(); ++column) {
    if (!L.col(column).isZero(0.0)) allowed.push_back(column);
  }
  Evidence evidence;
  evidence.HL = HL(Eigen::all, allowed);
  const MatrixXd of_allowed = B(allowed, allowed);
  evidence.factor.compute(of_allowed);
  const VectorXd h = L.transpose() * of_machine.vector;
  const VectorXd w = evidence.factor.matrixL().solve(VectorXd(h(allowed)));
  const double log_determinant = 2.0 * evidence.factor.matrixLLT().diagonal().array().log().sum();
  evidence.log = 0.5 * (w.squaredNorm() - log_determinant - theta.dot(pi_ * theta));
  evidence.b = of_machine.vector - evidence.HL * evidence.factor.matrixU().solve(w);
  return evidence;
}

MatrixXd PopulationEvidence::Evidence::A(const MatrixXd& H) const {
  const MatrixXd LH = HL.transpose();
  const MatrixXd half = factor.matrixL().solve(LH);
  return H - half.transpose() * half;
}

void PopulationEvidence::EachBlock(const std::function<void(Index, Index)>& of_block) const {
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      const Index size = model_.Function(axis, motion).size();
      if (size > 0) of_block(first_[axis][motion], size);
    }
  }
  of_block(squareness_, 3);
}

std::vector<PopulationEvidence::Part> PopulationEvidence::Parts(const VectorXd& theta) const {
  const ErrorPopulation population = PopulationAt(theta);
  const MachinePrior prior = stated_.With(population);
  std::vector<Part> parts;
  for (Index i = 0; i < count(); i += 2) {
    const auto [line, axis, motion] = knobs_[i];
    if (axis < 0) break;
    const Index at = first_[axis][motion];
    const auto unit = prior.UnitCovariance(axis, motion);
    const double variance = std::pow(population.deviation(axis, motion), 2);
    parts.push_back({i, at, 2.0 * variance * unit.covariance});
    parts.push_back({i + 1, at, variance * unit.by_length});
    if (line != kPositioning) continue;
    parts.push_back({of_functions() + 1, at,
                     2.0 * population.scale * population.scale * prior.UnitSlope(axis)});
  }
  for (Index i = of_functions() + 2; i < count(); i += 2) {
    const int axis = knobs_[i].axis;
    const auto unit = prior.UnitWave(axis);
    const double variance = std::pow(population.wave[axis], 2);
    parts.push_back({i, first_[axis][axis], 2.0 * variance * unit.covariance});
    parts.push_back({i + 1, first_[axis][axis], variance * unit.by_length});
  }
  parts.push_back({of_functions(), squareness_,
                   2.0 * std::pow(population.squareness, 2) * MatrixXd::Identity(3, 3)});
  return parts;
}

PopulationEvidence::Slopes PopulationEvidence::SlopesAt(const Quadratic& of_machine,
                                                        const VectorXd& theta,
                                                        const Evidence& evidence) const {
  const std::vector<Part> parts = Parts(theta);
  const MatrixXd A = evidence.A(of_machine.information);
  Slopes local{VectorXd::Zero(count()), MatrixXd::Zero(count(), count())};
  for (const Part& one : parts) {
    const Index n = one.slope.rows();
    const auto b = evidence.b.segment(one.at, n);
    local.gradient[one.knob] +=
        0.5 * (b.dot(one.slope * b) - one.slope.cwiseProduct(A.block(one.at, one.at, n, n)).sum());
  }
  std::vector<MatrixXd> rows(parts.size());  // slope * A, of each part
  estimation::InParallel(parts.size(), [&](std::size_t i) {
    rows[i] = parts[i].slope * A.middleRows(parts[i].at, parts[i].slope.rows());
  });
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (std::size_t j = 0; j < parts.size(); ++j) {
      const Index m = parts[i].slope.rows(), n = parts[j].slope.rows();
      local.fisher(parts[i].knob, parts[j].knob) +=
          0.5 * rows[i]
                    .middleCols(parts[j].at, n)
                    .cwiseProduct(rows[j].middleCols(parts[i].at, m).transpose())
                    .sum();
    }
  }
  return local;
}

VectorXd PopulationEvidence::AtBestLength(const Quadratic& of_machine) const {
  std::array<VectorXd, kCommonLengths.size()> thetas;
  std::array<double, kCommonLengths.size()> logs{};
  estimation::InParallel(thetas.size(), [&](std::size_t length) {
    thetas[length] = VectorXd::Zero(count());
    for (Index i = 0; i < count(); ++i) {
      if (IsLength(i)) thetas[length][i] = std::log(kCommonLengths[length]);
    }
    logs[length] = At(of_machine, thetas[length]).log;
  });
  double best = -std::numeric_limits<double>::infinity();
  VectorXd chosen = VectorXd::Zero(count());
  for (std::size_t length = 0; length < thetas.size(); ++length) {
    if (logs[length] > best) {
      best = logs[length];
      chosen = thetas[length];
    }
  }
  return chosen;
}

PopulationEvidence::Maximum PopulationEvidence::Maximise(const Quadratic& of_machine,
                                                         const VectorXd& theta, Index free) const {
  Maximum highest{theta, 0.0, {}};
  Evidence now = At(of_machine, theta);
  for (int step = 0; step < kSteps; ++step) {
    MayBeInterrupted();
    highest.local = SlopesAt(of_machine, highest.theta, now);
    const VectorXd slope = highest.local.gradient - pi_ * highest.theta;
    VectorXd way = VectorXd::Zero(count());
    const MatrixXd curvature = (highest.local.fisher + pi_).topLeftCorner(free, free);
    way.head(free) = curvature.ldlt().solve(VectorXd(slope.head(free)));
    const double gain = 0.5 * slope.dot(way);
    if (gain < kGainSettled) break;
    way *= std::min(1.0, kLongestStep / way.cwiseAbs().maxCoeff());
    Evidence next = At(of_machine, highest.theta + way);
    for (int halves = 0; halves < 5 && !(next.log > now.log); ++halves) {
      way *= 0.4;
      next = At(of_machine, highest.theta + way);
    }
    if (!(next.log > now.log)) break;
    highest.theta += way;
    now = std::move(next);
  }
  highest.log = now.log;
  return highest;
}

bool PopulationEvidence::IsEvident(const Quadratic& of_machine, const VectorXd& theta,
                                   Index wave) const {
  VectorXd without = theta;
  without[wave] = std::log(kNoWave);
  // All without the prior of the size.
  const auto prior = [&](const VectorXd& at) {
    return 0.5 * pi_(wave, wave) * at[wave] * at[wave];
  };
  const double needed = At(of_machine, theta).log + prior(theta) - prior(without) - kEvident;
  return At(of_machine, without).log <= needed &&
         Maximise(of_machine, without, of_functions() + 2).log <= needed;
}

std::array<bool, machine::kAxes> PopulationEvidence::EvidentWaves(const Quadratic& of_machine,
                                                                  const VectorXd& theta) const {
  std::array<bool, machine::kAxes> evident{};
  for (Index knob = 0; knob < count(); ++knob) {
    const auto [line, axis, motion] = knobs_[knob];
    if (line == kWave) evident[axis] = IsEvident(of_machine, theta, knob);
  }
  return evident;
}

std::vector<Statement> PopulationEvidence::Statements(const Maximum& at) const {
  std::vector<Statement> statements;
  for (const LineInFile& line : LinesInFile()) {
    statements.push_back(
        {.key = line.key, .unit = line.unit, .stated = machine_.population.*line.value});
  }
  MatrixXd X = MatrixXd::Zero(count(), kLines);
  for (Index i = 0; i < count() - waves_; ++i) X(i, knobs_[i].line) = 1.0;
  MatrixXd information = X.transpose() * at.local.fisher * X;
  information.diagonal().array() += 1e-9;
  const MatrixXd C = information.inverse();
  const VectorXd logs = C * X.transpose() * ((at.local.fisher + pi_) * at.theta);
  for (Index line = 0; line < kLines; ++line) {
    Statement& each = statements[line];
    each.u_log = std::sqrt(C(line, line));
    each.seen = each.stated * std::exp(logs[line]);
  }
  return statements;
}

MatrixXd PopulationEvidence::MovedByTheta(const Quadratic& of_machine, const VectorXd& theta,
                                          const MatrixXd& cov) const {
  const Evidence evidence = At(of_machine, theta);
  const MatrixXd A = evidence.A(of_machine.information);
  const MatrixXd L = FactorAt(theta);
  MatrixXd moved = MatrixXd::Zero(evidence.b.size(), theta.size());
  for (const Part& part : Parts(theta)) {
    const Index n = part.slope.rows();
    moved.block(part.at, part.knob, n, 1) += part.slope * evidence.b.segment(part.at, n);
  }
  moved -= L * (L.transpose() * (A * moved));
  return moved * MatrixXd(cov.llt().matrixL());
}

}  // namespace abbe::fusion
