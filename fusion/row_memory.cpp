#include "fusion/row_memory.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "estimation/in_parallel.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kRowsOfStated = 20.0;  // n
constexpr double kSeenInRows = 0.03;    // noise: what parameters leave open below it is nothing
constexpr double kNoPrior = 1e-9;       // of its information by the rows, of a parameter of theirs
constexpr Index kMostInstants = 600, kGroup = 10;
constexpr double kMostSteps = 1e5;                  // of a run, of which a memory has some
constexpr double kShortest = 2.0, kLongest = 10.0;  // steps; whole runs
constexpr double kWorthALook = 1.0;  // a gain on the grid: where it peaks at 5 it has 2.6
constexpr double kLeastRatio = 0.15, kMostRatio = 1000.0;

// A memory of ratio * white, over white noise of 1.
struct MemoryForm {
  double log_ratio, log_time;
};

// Groups of neighbours, evenly from the whole run.
std::vector<Index> ChosenInstants(Index count) {
  std::vector<Index> chosen;
  const Index groups = count <= kMostInstants ? 1 : kMostInstants / kGroup;
  const Index of_each = groups == 1 ? count : kGroup;
  for (Index group = 0; group < groups; ++group) {
    const Index first = groups == 1 ? 0 : group * (count - kGroup) / (groups - 1);
    for (Index i = first; i < first + of_each; ++i) chosen.push_back(i);
  }
  return chosen;
}

// Without those that a robust loss hardly counts.
std::vector<Index> UsualInstants(const VectorXd& left, Index channels,
                                 const std::vector<Index>& instants) {
  constexpr double kFarOff = 25.0;  // of the median square
  const auto square = [&](Index instant) {
    return left.segment(instant * channels, channels).squaredNorm();
  };
  std::vector<double> squares;
  squares.reserve(instants.size());
  for (const Index instant : instants) squares.push_back(square(instant));
  const auto middle = squares.begin() + std::ssize(squares) / 2;
  std::nth_element(squares.begin(), middle, squares.end());
  std::vector<Index> usual;
  for (const Index instant : instants) {
    if (square(instant) <= kFarOff * *middle) usual.push_back(instant);
  }
  return usual;
}

class RowDensity {
 public:
  explicit RowDensity(const RowsInTime& rows) {
    const Index instants = rows.times.size();
    channels_ = rows.left.size() / instants;
    times_ = rows.times;
    // The channels one after the other.
    std::vector<Index> order;
    for (Index channel = 0; channel < channels_; ++channel) {
      for (Index instant = 0; instant < instants; ++instant) {
        order.push_back(instant * channels_ + channel);
      }
    }
    // Parameters of the rows alone are as good as free.
    MatrixXd H = rows.priors;
    H.diagonal() += kNoPrior * rows.J.colwise().squaredNorm().transpose();
    std::vector<Index> seen;
    for (Index i = 0; i < H.rows(); ++i) {
      if (H(i, i) > 0.0) seen.push_back(i);
    }
    const VectorXd scale = H.diagonal()(seen).cwiseSqrt().cwiseInverse();
    MatrixXd scaled = scale.asDiagonal() * H(seen, seen) * scale.asDiagonal();
    scaled.diagonal().array() += 1e-12;
    const Eigen::LLT<MatrixXd> factor(scaled);
    const MatrixXd J = rows.J(order, seen) * scale.asDiagonal();
    const VectorXd g = scale.cwiseProduct(rows.score(seen));
    off_ = rows.left(order) - J * factor.solve(g);
    const MatrixXd open = factor.matrixL().solve(J.transpose()).transpose();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(MatrixXd(open.transpose() * open));
    Index few = 0;
    while (few < eigen.eigenvalues().size() &&
           eigen.eigenvalues()[few] < kSeenInRows * kSeenInRows) {
      ++few;
    }
    open_ = open * eigen.eigenvectors().rightCols(eigen.eigenvectors().cols() - few);
  }

  // Between instants: the median, but no less than a share of the whole that can be resolved.
  double step() const {
    VectorXd steps = times_.tail(times_.size() - 1) - times_.head(times_.size() - 1);
    const auto middle = steps.begin() + steps.size() / 2;
    std::nth_element(steps.begin(), middle, steps.end());
    return std::max(*middle, whole() / kMostSteps);
  }
  double whole() const { return times_[times_.size() - 1] - times_[0]; }

  struct At {
    double log = -std::numeric_limits<double>::infinity(), white = 1.0;
  };
  // At the most probable white noise. `memory`: over white noise of 1.
  At Highest(const estimation::NoiseMemory& memory) const {
    const estimation::MemoryFilter filter(times_, memory);
    MatrixXd open = open_;
    VectorXd off = off_;
    WhitenBy(memory, open, off);
    const MatrixXd G = open.transpose() * open;
    const VectorXd g = open.transpose() * off;
    const double squares = off.squaredNorm();
    const double determinant = channels_ * filter.log_determinant();
    const auto log_at = [&](double log_white) {
      const double precision = std::exp(-2.0 * log_white);
      MatrixXd known = precision * G;
      known.diagonal().array() += 1.0;
      const Eigen::LLT<MatrixXd> factor(known);
      const double chi_square =
          precision * squares - precision * precision * g.dot(factor.solve(g));
      const double volume = determinant + 2.0 * off.size() * log_white +
                            2.0 * factor.matrixLLT().diagonal().array().log().sum();
      const double stated = kRowsOfStated * (2.0 * log_white + precision);
      return -0.5 * (chi_square + volume + stated);
    };
    // Uphill by the parabola through three, as far as these reach.
    double centre = 0.5 * std::log((squares + kRowsOfStated) / (off.size() + kRowsOfStated));
    double here = log_at(centre);
    for (double step = 0.5; step > 0.01; step *= 0.3) {
      double below = log_at(centre - step), above = log_at(centre + step);
      while (std::max(below, above) > here) {
        const bool up = above > below;
        centre += up ? step : -step;
        (up ? below : above) = std::exchange(here, up ? above : below);
        (up ? above : below) = log_at(up ? centre + step : centre - step);
      }
      const double bend = 2.0 * here - above - below;
      if (!(bend > 0.0)) continue;
      const double to = centre + 0.5 * step * (above - below) / bend;
      const double there = log_at(to);
      if (there > here) {
        centre = to;
        here = there;
      }
    }
    return {here, std::exp(centre)};
  }

  // Whether the sums of neighbours scatter as this memory says.
  bool ScattersLike(const estimation::NoiseMemory& noise) const {
    constexpr Index kFewest = 12;        // sums
    constexpr double kImprobable = 3.3;  // standard deviations: one of a thousand
    MatrixXd open = open_;
    VectorXd off = off_;
    WhitenBy(noise, open, off);
    MatrixXd known = open.transpose() * open;
    known.diagonal().array() += 1.0;
    const Eigen::LLT<MatrixXd> factor(known);
    const VectorXd left = off - open * factor.solve(open.transpose() * off);
    const Index n = times_.size();
    for (Index length = 2; channels_ * (n / length) >= kFewest; length *= 2) {
      const Index of_channel = n / length;
      VectorXd sums(channels_ * of_channel);
      MatrixXd by_open(sums.size(), open.cols());
      for (Index k = 0; k < sums.size(); ++k) {
        const Index first = (k / of_channel) * n + (k % of_channel) * length;
        sums[k] = left.segment(first, length).sum();
        by_open.row(k) = open.middleRows(first, length).colwise().sum();
      }
      const double rows = static_cast<double>(length);
      // What parameters take of the sums is no freedom of theirs.
      const double taken = factor.matrixL().solve(by_open.transpose()).squaredNorm() / rows;
      const double freedom = static_cast<double>(sums.size()) - taken;
      if (freedom < static_cast<double>(kFewest)) continue;
      // Chi-square as a normal number: Wilson and Hilferty (1931).
      const double spread = 2.0 / (9.0 * freedom);
      const double pull =
          (std::cbrt(sums.squaredNorm() / rows / freedom) - (1.0 - spread)) / std::sqrt(spread);
      if (std::abs(pull) > kImprobable) return false;
    }
    return true;
  }

 private:
  void WhitenBy(const estimation::NoiseMemory& noise, MatrixXd& open, VectorXd& off) const {
    const estimation::MemoryFilter filter(times_, noise);
    const Index n = times_.size();
    for (Index channel = 0; channel < channels_; ++channel) {
      filter.Whiten(open.middleRows(channel * n, n));
      filter.Whiten(off.segment(channel * n, n));
    }
  }

  Index channels_ = 1;
  VectorXd times_;
  VectorXd off_;   // r - J H^-1 g
  MatrixXd open_;  // F with F F' = J H^-1 J', but for what is nothing
};

struct Trial {
  MemoryForm form;
  RowDensity::At at;
};

estimation::NoiseMemory MemoryOf(const MemoryForm& form) {
  return {1.0, std::exp(form.log_ratio), std::exp(form.log_time)};
}

// The best of a grid, then, unless all of it is below `worth`, of its neighbours at half the
// distance, ...
Trial HighestDensity(const RowDensity& density, double worth) {
  const double shortest = std::log(kShortest * density.step());
  const double longest = std::log(kLongest * density.whole());
  const double least = std::log(kLeastRatio), most = std::log(kMostRatio);
  double step = std::log(4.0);
  std::vector<Trial> tried;
  for (double time = shortest; time < longest + step; time += step) {
    for (double ratio = least; ratio < most; ratio += step) {
      tried.push_back({{ratio, std::min(time, longest)}, {}});
    }
  }
  const auto best_of = [&](std::vector<Trial>& all) {
    estimation::InParallel(
        all.size(), [&](std::size_t i) { all[i].at = density.Highest(MemoryOf(all[i].form)); });
    return *std::max_element(all.begin(), all.end(),
                             [](const Trial& a, const Trial& b) { return a.at.log < b.at.log; });
  };
  Trial best = best_of(tried);
  if (!(best.at.log > worth)) return best;
  for (int halving = 0; halving < 3; ++halving) {
    step /= 2.0;
    std::vector<Trial> around{best};
    for (const double time : {-step, 0.0, step}) {
      for (const double ratio : {-step, 0.0, step}) {
        around.push_back({{std::clamp(best.form.log_ratio + ratio, least, most),
                           std::clamp(best.form.log_time + time, shortest, longest)},
                          {}});
      }
    }
    best = best_of(around);
  }
  return best;
}

}  // namespace

RowMemory FindRowMemory(const RowsInTime& rows) {
  RowMemory found;
  const Index instants = rows.times.size();
  if (instants < kFewestInstants || rows.left.size() % instants != 0) return found;
  if (!(rows.times[instants - 1] > rows.times[0])) return found;
  const RowDensity density(rows);
  const RowDensity::At white = density.Highest({1.0, 0.0, density.whole()});
  const Trial best = HighestDensity(density, white.log + kWorthALook);
  found.gain = best.at.log - white.log;
  found.noise = MemoryOf(best.form);
  found.noise.white *= best.at.white;
  found.noise.slow *= best.at.white;
  found.sums_agree = density.ScattersLike(found.noise);
  return found;
}

RowMemory FindRowMemory(const estimation::Problem& problem, const estimation::Layout& layout,
                        const VectorXd& x, const estimation::Linearization& at, std::size_t run,
                        const VectorXd& times) {
  const auto& terms = problem.terms();
  const auto of_run = std::find_if(terms.begin(), terms.end(), [&](const estimation::Term& term) {
    return term.source.index == static_cast<int>(run);
  });
  if (of_run == terms.end() || times.size() < kFewestInstants) return {};
  MatrixXd H = at.prior.information;
  VectorXd g = at.prior.gradient;
  for (std::size_t s = 0; s < at.sources.size(); ++s) {
    if (!problem.sources()[s].options.is_prior) continue;
    H += at.sources[s].information;
    g += at.sources[s].gradient;
  }
  estimation::RowEvaluator rows(problem, layout);
  const auto* found = rows.Evaluate(*of_run, x, true);
  if (found == nullptr || found->r.size() % times.size() != 0) return {};
  const Index channels = found->r.size() / times.size();
  std::vector<Index> instants = ChosenInstants(times.size());
  if (problem.sources()[run].options.loss.kind != estimation::RobustLoss::Kind::kNone) {
    instants = UsualInstants(found->r, channels, instants);
  }
  std::vector<Index> chosen;
  for (const Index instant : instants) {
    for (Index channel = 0; channel < channels; ++channel) {
      chosen.push_back(instant * channels + channel);
    }
  }
  MatrixXd J = MatrixXd::Zero(std::ssize(chosen), layout.columns());
  J(Eigen::all, found->columns) = found->jacobian(chosen, Eigen::all);
  const VectorXd times_chosen = times(instants), left = found->r(chosen);
  return FindRowMemory({times_chosen, J, left, H, g});
}

bool TakeUp(const RowMemory& found, double& white, std::optional<estimation::NoiseMemory>& memory) {
  constexpr double kWhiteSettled = 0.05, kSlowSettled = 0.2;  // of a logarithm
  if (!(found.gain > kRemembers)) {
    if (memory) white = memory->white;
    return std::exchange(memory, std::nullopt).has_value();
  }
  const auto settled = [](double a, double b, double within) {
    return std::abs(std::log(a / b)) < within;
  };
  if (memory && settled(found.noise.white, memory->white, kWhiteSettled) &&
      settled(found.noise.slow, memory->slow, kSlowSettled)) {
    return false;
  }
  memory = found.noise;
  white = 1.0;
  return true;
}

}  // namespace abbe::fusion
