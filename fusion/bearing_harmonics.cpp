#include "fusion/bearing_harmonics.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>

#include "estimation/problem.h"
#include "failure/failure.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;

constexpr double kLeastProbeNoise = 1e-9;  // m: below that of any probe in a workshop

std::string NameOf(const char* wave, int order) { return fmt::format("shaft_{}_{}", wave, order); }

// [1 sin cos sin cos ...]
Eigen::RowVectorXd Row(double angle, const std::vector<int>& orders) {
  Eigen::RowVectorXd row(1 + 2 * orders.size());
  row[0] = 1.0;
  for (std::size_t k = 0; k < orders.size(); ++k) {
    row[1 + 2 * k] = std::sin(orders[k] * angle);
    row[2 + 2 * k] = std::cos(orders[k] * angle);
  }
  return row;
}

void Check(std::span<const double> angles, std::span<const double> values,
           const std::vector<int>& orders) {
  if (std::ranges::any_of(orders, [](int order) { return order < 1; })) {
    throw InputError("orders of harmonics count from 1");
  }
  if (angles.size() != values.size() || values.size() < 2 * orders.size() + 2) {
    throw InputError(fmt::format(
        "{} harmonics of {} angles and {} readings: they need at least {} of each; record longer",
        orders.size(), angles.size(), values.size(), 2 * orders.size() + 2));
  }
}

estimation::Result Solve(const Eigen::MatrixXd& A, const Eigen::VectorXd& values,
                         const std::vector<int>& orders, double noise) {
  estimation::ParameterBlock bearing("bearing", {"um", 1e-6}, {});
  for (const int order : orders) {
    bearing.entries.push_back({NameOf("sin", order)});
    bearing.entries.push_back({NameOf("cos", order)});
  }
  estimation::Problem problem;
  const auto mean = problem.Add({"mean", {"um", 1e-6}, {{"gap"}}});
  std::vector<estimation::Input> inputs{mean};
  if (!orders.empty()) inputs.emplace_back(problem.Add(bearing));
  problem.Add(problem.AddSource("readings"),
              std::make_shared<estimation::LinearResidual>(A, values), inputs, noise);
  estimation::Result result = problem.Solve();
  if (!result.Usable()) {
    throw NumericalError(
        fmt::format("harmonics of a shaft: {}; turn it by whole turns or ask for lower orders",
                    result.WhyNotUsable()));
  }
  return result;
}

}  // namespace

double BearingHarmonics::At(double angle) const {
  double value = result.Value("mean.gap");
  for (const int order : orders) {
    value += result.Value("bearing." + NameOf("sin", order)) * std::sin(order * angle) +
             result.Value("bearing." + NameOf("cos", order)) * std::cos(order * angle);
  }
  return value;
}

double BearingHarmonics::Amplitude(int order) const {
  return std::hypot(result.Value("bearing." + NameOf("sin", order)),
                    result.Value("bearing." + NameOf("cos", order)));
}

BearingHarmonics FitBearing(std::span<const double> angles, std::span<const double> values,
                            const std::vector<int>& orders) {
  Check(angles, values, orders);
  const Index n = values.size();
  Eigen::MatrixXd A(n, 1 + 2 * orders.size());
  for (Index i = 0; i < n; ++i) A.row(i) = Row(angles[i], orders);
  const Eigen::Map<const Eigen::VectorXd> b(values.data(), n);
  BearingHarmonics fit{orders, Solve(A, b, orders, kLeastProbeNoise)};
  fit.rms = RmsAbout(fit, angles, values);
  // Again with the estimated noise, for the uncertainties.
  fit.result = Solve(A, b, orders, std::max(fit.rms, kLeastProbeNoise));
  return fit;
}

double RmsAbout(const BearingHarmonics& fit, std::span<const double> angles,
                std::span<const double> values) {
  double squares = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    squares += std::pow(values[i] - fit.At(angles[i]), 2);
  }
  return std::sqrt(squares / values.size());
}

}  // namespace abbe::fusion
