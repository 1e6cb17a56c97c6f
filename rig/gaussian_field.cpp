#include "rig/gaussian_field.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace abbe::rig {
namespace {

constexpr double kStep = 0.5;  // between nodes, in lengths

constexpr std::int64_t kMostKept = 600;  // nodes of a surface along one coordinate

// The node nearest to a coordinate.
std::int64_t NodeAt(double coordinate, double length) {
  return std::llround(coordinate / (kStep * length));
}

// The height of the bells that gives one coordinate unit variance: the sum of the squared bells
// over the grid is sqrt(pi / 2) * length / step.
double UnitAmplitude() { return std::sqrt(kStep / std::sqrt(std::numbers::pi / 2.0)); }

std::uint64_t Index(std::int64_t a, std::int64_t b) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32 |
         static_cast<std::uint32_t>(b);
}

}  // namespace

// With the offset o from the middle node and the step s, in lengths, bell k from the middle is
// exp(-(o - s k)^2): neighbours differ by a factor that itself shrinks by exp(-2 s^2), so that a
// few exponentials serve all of them.
BellWindow::BellWindow(double coordinate, double length) {
  const std::int64_t middle = NodeAt(coordinate, length);
  first = middle - kReach;
  const double offset = coordinate / length - kStep * middle;
  const double at_middle = std::exp(-offset * offset);
  const double shrink = std::exp(-2.0 * kStep * kStep);
  const double first_step = std::exp(-kStep * kStep);
  const double towards = std::exp(2.0 * kStep * offset);
  bells[kReach] = at_middle;
  double up = at_middle, up_step = first_step * towards;
  double down = at_middle, down_step = first_step / towards;
  for (int k = 1; k <= kReach; ++k) {
    bells[kReach + k] = up *= up_step;
    bells[kReach - k] = down *= down_step;
    up_step *= shrink;
    down_step *= shrink;
  }
}

GaussianProcess::GaussianProcess(const random::CounterRandom& random, double sd, double length,
                                 double low, double high)
    : random_(random),
      amplitude_(sd * UnitAmplitude()),
      length_(length),
      first_(NodeAt(low, length) - BellWindow::kReach - 1) {
  const std::int64_t end = NodeAt(high, length) + BellWindow::kReach + 2;
  for (std::int64_t node = first_; node < end; ++node) {
    weights_.push_back(random_.Normal(node));
  }
}

double GaussianProcess::At(const BellWindow& window) const {
  const std::int64_t at = window.first - first_;
  double sum = 0.0;
  if (at >= 0 && at + BellWindow::kNodes <= std::ssize(weights_)) {
    const double* weights = weights_.data() + at;
    for (int k = 0; k < BellWindow::kNodes; ++k) sum += window.bells[k] * weights[k];
  } else {
    for (int k = 0; k < BellWindow::kNodes; ++k) {
      sum += window.bells[k] * random_.Normal(window.first + k);
    }
  }
  return amplitude_ * sum;
}

void GaussianProcess::Add(const GaussianProcess& more, double share) {
  if (more.amplitude_ == 0.0) return;
  if (amplitude_ == 0.0) {  // none so far
    amplitude_ = more.amplitude_;
    std::fill(weights_.begin(), weights_.end(), 0.0);
  }
  for (std::size_t i = 0; i < weights_.size(); ++i) {
    weights_[i] += share * more.amplitude_ / amplitude_ * more.weights_[i];
  }
}

GaussianSurface::GaussianSurface(const random::CounterRandom& random, double sd, double length,
                                 double low, double high)
    : random_(random),
      amplitude_(sd * UnitAmplitude() * UnitAmplitude()),
      length_(length),
      first_(NodeAt(low, length) - BellWindow::kReach),
      count_(std::min(kMostKept, NodeAt(high, length) + BellWindow::kReach + 1 - first_)) {
  weights_.reserve(count_ * count_);
  for (std::int64_t a = 0; a < count_; ++a) {
    for (std::int64_t b = 0; b < count_; ++b) {
      weights_.push_back(random_.Normal(Index(first_ + a, first_ + b)));
    }
  }
}

double GaussianSurface::operator()(double a, double b) const {
  const BellWindow window_a(a, length_), window_b(b, length_);
  const std::int64_t row = window_a.first - first_, column = window_b.first - first_;
  const std::int64_t last = count_ - BellWindow::kNodes;
  const bool kept = row >= 0 && row <= last && column >= 0 && column <= last;
  double sum = 0.0;
  for (int i = 0; i < BellWindow::kNodes; ++i) {
    double along_b = 0.0;
    if (kept) {
      const double* weights = weights_.data() + (row + i) * count_ + column;
      for (int j = 0; j < BellWindow::kNodes; ++j) along_b += window_b.bells[j] * weights[j];
    } else {
      for (int j = 0; j < BellWindow::kNodes; ++j) {
        along_b +=
            window_b.bells[j] * random_.Normal(Index(window_a.first + i, window_b.first + j));
      }
    }
    sum += window_a.bells[i] * along_b;
  }
  return amplitude_ * sum;
}

}  // namespace abbe::rig
