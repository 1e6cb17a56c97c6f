#include "standards/harmonics.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cstddef>

#include "failure/failure.h"

namespace abbe::standards {
namespace {

using Row = Eigen::RowVectorXd;

void CheckReadings(std::span<const double> angles, std::span<const double> values, int highest) {
  if (highest < 0 || angles.size() != values.size() ||
      angles.size() < static_cast<std::size_t>(2 * highest + 1)) {
    throw InputError(fmt::format(
        "harmonics up to order {} of {} angles and {} values: they need at least {} of each",
        highest, angles.size(), values.size(), 2 * highest + 1));
  }
  for (std::size_t i = 0; i < angles.size(); ++i) {
    if (!std::isfinite(angles[i]) || !std::isfinite(values[i])) {
      throw InputError(fmt::format("harmonics, reading {}: angle {}, value {}: give finite numbers",
                                   i + 1, angles[i], values[i]));
    }
  }
}

// [1 cos t sin t cos 2t sin 2t ...]
Row Waves(double angle, int highest) {
  Row row(2 * highest + 1);
  row[0] = 1.0;
  for (int n = 1; n <= highest; ++n) {
    row[2 * n - 1] = std::cos(n * angle);
    row[2 * n] = std::sin(n * angle);
  }
  return row;
}

}  // namespace

double HarmonicFit::At(double angle) const {
  double value = mean;
  for (const Harmonic& wave : harmonics) {
    value += wave.cosine * std::cos(wave.order * angle) + wave.sine * std::sin(wave.order * angle);
  }
  return value;
}

HarmonicFit FitHarmonics(std::span<const double> angles, std::span<const double> values,
                         int highest) {
  CheckReadings(angles, values, highest);
  const Eigen::Index n = values.size();
  Eigen::MatrixXd A(n, 2 * highest + 1);
  Eigen::VectorXd b(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    A.row(i) = Waves(angles[i], highest);
    b[i] = values[i];
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
  if (qr.rank() < A.cols()) {
    throw NumericalError(fmt::format(
        "harmonics up to order {}: the {} angles do not separate them; measure whole turns or "
        "ask for fewer",
        highest, n));
  }
  const Eigen::VectorXd c = qr.solve(b);
  const double squares = (b - A * c).squaredNorm();
  const double freedom = std::max(1.0, static_cast<double>(n - A.cols()));
  HarmonicFit fit{c[0], {}, std::sqrt(squares / n)};
  for (int order = 1; order <= highest; ++order) {
    fit.harmonics.push_back(
        {order, c[2 * order - 1], c[2 * order], std::sqrt(2.0 * squares / freedom / n)});
  }
  return fit;
}

}  // namespace abbe::standards
