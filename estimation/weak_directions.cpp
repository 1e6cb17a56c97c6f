#include "estimation/weak_directions.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "estimation/rounding.h"

namespace abbe::estimation {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kUnseen = 1.0;  // lambda below which less than half of the variance is removed
constexpr double kShownCoefficient = 0.1;
constexpr std::size_t kMostTerms = 6;
constexpr int kMostTurns = 50;

MatrixXd Reference(const MatrixXd& data, const MatrixXd& prior) {
  MatrixXd reference = prior;
  VectorXd rounding = kRounding * (data.diagonal() + prior.diagonal());
  // A parameter without any information has no scale of its own; 1 is as good as any.
  for (double& r : rounding) r = r > 0.0 ? r : 1.0;
  reference.diagonal() += rounding;
  return reference;
}

// Directions v = L^-T q of the whitened space, W = L L', and the information lambda along each.
struct Spectrum {
  MatrixXd reference;
  MatrixXd whitened;  // q, orthonormal columns, lambda rising
  VectorXd lambda;
  Index weak = 0;  // the first `weak` directions have lambda < 1
  Eigen::LLT<MatrixXd> factor;

  MatrixXd Unwhiten(const MatrixXd& q) const { return factor.matrixU().solve(q); }
};

Spectrum SpectrumOf(const MatrixXd& data, MatrixXd reference) {
  Spectrum s;
  s.reference = std::move(reference);
  s.factor.compute(s.reference);
  MatrixXd scaled = s.factor.matrixL().solve(data);
  scaled = s.factor.matrixL().solve(scaled.transpose()).eval();
  const MatrixXd symmetric = 0.5 * (scaled + scaled.transpose());
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(symmetric);
  s.whitened = eigen.eigenvectors();
  s.lambda = eigen.eigenvalues().cwiseMax(0.0);
  while (s.weak < s.lambda.size() && s.lambda[s.weak] < kUnseen) ++s.weak;
  return s;
}

// Rotates the columns of `a` among themselves, and those of `along` with them, to the largest sum
// of fourth powers (quartimax): few large numbers per column.
void TurnToSimple(MatrixXd& a, MatrixXd& along) {
  for (int turn = 0; turn < kMostTurns; ++turn) {
    double largest = 0.0;
    for (Index i = 0; i < a.cols(); ++i) {
      for (Index j = i + 1; j < a.cols(); ++j) {
        const VectorXd u = a.col(i).cwiseAbs2() - a.col(j).cwiseAbs2();
        const VectorXd w = 2.0 * a.col(i).cwiseProduct(a.col(j));
        const double angle = 0.25 * std::atan2(2.0 * u.dot(w), u.squaredNorm() - w.squaredNorm());
        const Eigen::JacobiRotation<double> rotation(std::cos(angle), -std::sin(angle));
        a.applyOnTheRight(i, j, rotation);
        along.applyOnTheRight(i, j, rotation);
        largest = std::max(largest, std::abs(angle));
      }
    }
    if (largest < 1e-9) break;
  }
}

void MakeFirstLargePositive(VectorXd& coefficients) {
  const double large = 0.99 * coefficients.cwiseAbs().maxCoeff();
  for (const double c : coefficients) {
    if (std::abs(c) < large) continue;
    if (c < 0.0) coefficients *= -1.0;
    return;
  }
}

WeakDirection::Held WhoHolds(const VectorXd& v, const MatrixXd& prior, const VectorXd& tolerance) {
  constexpr double kMostOfIt = 0.5;  // v' W v = 1
  if (v.dot(prior * v) > kMostOfIt) return WeakDirection::Held::kByPrior;
  if (v.dot(tolerance.cwiseProduct(v)) > kMostOfIt) return WeakDirection::Held::kByTolerance;
  return WeakDirection::Held::kByNothing;
}

// The weak directions that the prior does not determine either, as combinations of the weak ones: weak x k.
MatrixXd UndeterminedOf(const Spectrum& spectrum, const MatrixXd& prior) {
  if (spectrum.weak == 0) return MatrixXd(0, 0);
  const MatrixXd v = spectrum.Unwhiten(spectrum.whitened.leftCols(spectrum.weak));
  const MatrixXd of_prior = v.transpose() * prior * v;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> share(of_prior);
  return share.eigenvectors().leftCols((share.eigenvalues().array() < 0.5).count());
}

// Combinations of the weak directions of a spectrum, the columns of `along` (weak x k), made simple.
std::vector<WeakDirection> Described(const Spectrum& spectrum, MatrixXd along,
                                     const MatrixXd& prior, const VectorXd& tolerance,
                                     const std::vector<std::string>& names) {
  if (along.cols() == 0) return {};
  const MatrixXd weak_directions = spectrum.Unwhiten(spectrum.whitened.leftCols(spectrum.weak));
  const VectorXd scale = spectrum.reference.diagonal().cwiseSqrt();
  MatrixXd coefficients = scale.asDiagonal() * (weak_directions * along);
  TurnToSimple(coefficients, along);
  const MatrixXd directions = weak_directions * along;
  const VectorXd variance = (1.0 + spectrum.lambda.head(spectrum.weak).array()).inverse();

  std::vector<WeakDirection> weak(along.cols());
  for (Index k = 0; k < along.cols(); ++k) {
    WeakDirection& direction = weak[k];
    direction.coefficients = coefficients.col(k).normalized();
    MakeFirstLargePositive(direction.coefficients);
    const double left = along.col(k).cwiseAbs2().dot(variance);
    direction.ratio = std::sqrt(left);
    direction.information = 1.0 / left - 1.0;
    direction.held = WhoHolds(directions.col(k), prior, tolerance);
    direction.words = InWords(direction.coefficients, names);
  }
  std::stable_sort(weak.begin(), weak.end(), [](const auto& a, const auto& b) {
    return a.held != b.held ? a.held > b.held : a.information < b.information;
  });
  return weak;
}

VectorXd ToleranceInformation(const MatrixXd& prior, const VectorXd& tolerances) {
  VectorXd information = tolerances.cwiseAbs2().cwiseInverse();  // 0 where infinite
  for (Index i = 0; i < information.size(); ++i) {
    if (prior(i, i) > 0.0) information[i] = 0.0;
  }
  return information;
}

// A positive definite matrix, factored with its diagonal scaled to 1.
class ScaledInverse {
 public:
  explicit ScaledInverse(const MatrixXd& total)
      : scale_(total.diagonal().cwiseSqrt().cwiseInverse()),
        factor_(scale_.asDiagonal() * total * scale_.asDiagonal()) {}

  bool certain() const { return HasFullRank(factor_); }
  MatrixXd Inverse() const {
    const MatrixXd inverse = scale_.asDiagonal() * factor_.solve(MatrixXd(scale_.asDiagonal()));
    return 0.5 * (inverse + inverse.transpose());
  }

 private:
  VectorXd scale_;
  Eigen::LLT<MatrixXd> factor_;
};

}  // namespace

std::string InWords(const VectorXd& coefficients, const std::vector<std::string>& names) {
  std::vector<Index> order(coefficients.size());
  std::iota(order.begin(), order.end(), Index{0});
  // Compared by the two printed digits: equal ones stay in the order of the parameters.
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    return std::round(100.0 * std::abs(coefficients[a])) >
           std::round(100.0 * std::abs(coefficients[b]));
  });
  std::string words;
  std::size_t shown = 0;
  for (const Index i : order) {
    const double size = std::abs(coefficients[i]);
    if (shown == kMostTerms || size < kShownCoefficient) break;
    const bool minus = coefficients[i] < 0.0;
    words += shown == 0 ? (minus ? "-" : "") : (minus ? " - " : " + ");
    words += fmt::format("{:.2f} {}", size, names[i]);
    ++shown;
  }
  const auto left = std::count_if(order.begin() + shown, order.end(),
                                  [&](Index i) { return std::abs(coefficients[i]) >= 0.01; });
  if (left > 0) words += fmt::format(" and {} smaller", left);
  return words;
}

std::vector<WeakDirection> FindWeakDirections(const MatrixXd& data, const MatrixXd& prior,
                                              const VectorXd& tolerances,
                                              const std::vector<std::string>& names) {
  if (data.rows() == 0) return {};
  const VectorXd tolerance = ToleranceInformation(prior, tolerances);
  MatrixXd reference = Reference(data, prior);
  reference.diagonal() += tolerance;
  const Spectrum spectrum = SpectrumOf(data, std::move(reference));
  return Described(spectrum, MatrixXd::Identity(spectrum.weak, spectrum.weak), prior, tolerance,
                   names);
}

std::vector<WeakDirection> FindUndeterminedDirections(const MatrixXd& data, const MatrixXd& prior,
                                                      const VectorXd& tolerances,
                                                      const std::vector<std::string>& names) {
  if (data.rows() == 0) return {};
  const Spectrum spectrum = SpectrumOf(data, Reference(data, prior));
  return Described(spectrum, UndeterminedOf(spectrum, prior), prior,
                   ToleranceInformation(prior, tolerances), names);
}

PosteriorCovariance InvertInformation(const MatrixXd& data, const MatrixXd& prior) {
  const Index n = data.rows();
  PosteriorCovariance result;
  if (n == 0) return result;
  const ScaledInverse total(data + prior);
  if (total.certain()) {
    result.determined = result.matrix = total.Inverse();
    return result;
  }
  const Spectrum spectrum = SpectrumOf(data, Reference(data, prior));
  const MatrixXd along = UndeterminedOf(spectrum, prior);
  result.undetermined = along.cols();
  if (result.undetermined == 0) {
    result.determined = result.matrix = total.Inverse();
    return result;
  }
  const MatrixXd undetermined = spectrum.whitened.leftCols(spectrum.weak) * along;
  MatrixXd root = spectrum.whitened * (1.0 + spectrum.lambda.array()).rsqrt().matrix().asDiagonal();
  root -= undetermined * (undetermined.transpose() * root).eval();
  root = spectrum.Unwhiten(root);
  result.determined = root * root.transpose();
  result.matrix = result.determined;
  const VectorXd open = spectrum.Unwhiten(undetermined).rowwise().squaredNorm();
  for (Index i = 0; i < n; ++i) {
    if (!(open[i] > result.determined(i, i))) continue;
    result.matrix.row(i).setConstant(std::numeric_limits<double>::quiet_NaN());
    result.matrix.col(i).setConstant(std::numeric_limits<double>::quiet_NaN());
    result.matrix(i, i) = std::numeric_limits<double>::infinity();
  }
  return result;
}

double ScaledCondition(const MatrixXd& data) {
  if (data.rows() == 0) return 1.0;
  if (!(data.diagonal().minCoeff() > 0.0)) return std::numeric_limits<double>::infinity();
  const VectorXd scale = data.diagonal().cwiseSqrt().cwiseInverse();
  const MatrixXd scaled = scale.asDiagonal() * data * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scaled, Eigen::EigenvaluesOnly);
  const double smallest = eigen.eigenvalues().minCoeff();
  const double largest = eigen.eigenvalues().maxCoeff();
  if (smallest < kRounding * largest) return std::numeric_limits<double>::infinity();
  return std::sqrt(largest / smallest);
}

}  // namespace abbe::estimation
