#include "diagnosis/scan.h"

#include <algorithm>
#include <cmath>

namespace abbe::diagnosis {

using Eigen::ArrayXd;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::vector<double> StrongestWaves(const Scan& scan, double step) {
  constexpr Index kTogether = 40;  // a product of matrices for so many
  const auto channels = static_cast<std::size_t>(scan.scores.rows());
  std::vector<double> found(channels, 0.0), strongest(channels, 0.0);
  // From line to line by the angle of a step.
  const ArrayXd first_cosine = (step * scan.values.array()).cos().transpose(),
                first_sine = (step * scan.values.array()).sin().transpose();
  const VectorXd all = scan.weights.rowwise().sum();
  MatrixXd cosine(scan.values.size(), kTogether), sine(scan.values.size(), kTogether);
  VectorXd last_cosine = VectorXd::Ones(scan.values.size()),
           last_sine = VectorXd::Zero(scan.values.size());
  for (Index first = 1; first <= kLines; first += kTogether) {
    for (Index i = 0; i < kTogether; ++i) {
      cosine.col(i) = last_cosine.array() * first_cosine - last_sine.array() * first_sine;
      sine.col(i) = last_cosine.array() * first_sine + last_sine.array() * first_cosine;
      last_cosine = cosine.col(i);
      last_sine = sine.col(i);
    }
    const MatrixXd of_sine = scan.weights * sine.cwiseAbs2(),
                   of_cosine = (-of_sine).colwise() + all;
    const Eigen::ArrayXXd power =
        (scan.scores * sine).array().square() / of_sine.array().max(1e-300) +
        (scan.scores * cosine).array().square() / of_cosine.array().max(1e-300);
    for (Index i = 0; i < kTogether && first + i <= kLines; ++i) {
      for (std::size_t c = 0; c < channels; ++c) {
        if (power(static_cast<Index>(c), i) <= strongest[c]) continue;
        strongest[c] = power(static_cast<Index>(c), i);
        found[c] = step * static_cast<double>(first + i);
      }
    }
  }
  return found;
}

std::vector<Interval> StrongestIntervals(const Scan& scan) {
  const Index channels = scan.scores.rows();
  std::vector<Interval> found(channels);
  if (scan.values.size() == 0) return found;
  const double first = scan.values.minCoeff(), last = scan.values.maxCoeff();
  const double length = last - first;
  if (!(length > 0.0)) return found;
  // Sums up to each border.
  MatrixXd score = MatrixXd::Zero(kLines + 1, channels), weight = score;
  for (Index row = 0; row < scan.values.size(); ++row) {
    const auto cell = static_cast<Index>((scan.values[row] - first) / length * kLines);
    const Index border = std::min(cell, kLines - 1) + 1;
    score.row(border) += scan.scores.col(row).transpose();
    weight.row(border) += scan.weights.col(row).transpose();
  }
  for (Index border = 1; border <= kLines; ++border) {
    score.row(border) += score.row(border - 1);
    weight.row(border) += weight.row(border - 1);
  }
  const auto place = [&](Index border) {
    if (border == kLines) return std::nextafter(last, 2.0 * last - first);
    return first + length * border / kLines;
  };
  for (Index c = 0; c < channels; ++c) {
    double strongest = 0.0;
    for (Index from = 0; from < kLines; ++from) {
      const Index count = kLines - from;
      Index cells = 0;
      const double power = ((score.col(c).tail(count).array() - score(from, c)).square() /
                            (weight.col(c).tail(count).array() - weight(from, c)).max(1e-300))
                               .maxCoeff(&cells);
      if (power <= strongest) continue;
      strongest = power;
      found[c] = {place(from), place(from + cells + 1)};
    }
  }
  return found;
}

}  // namespace abbe::diagnosis
