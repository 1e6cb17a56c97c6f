#include "fusion/bearing_harmonics.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "estimation/linearization.h"
#include "estimation/problem.h"
#include "failure/failure.h"
#include "fusion/machine_problem.h"
#include "fusion/row_memory.h"
#include "simulation/remembered_noise.h"

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
           const std::vector<int>& orders, std::span<const double> times) {
  if (std::ranges::any_of(orders, [](int order) { return order < 1; })) {
    throw InputError("orders of harmonics count from 1");
  }
  if (!times.empty() && times.size() != values.size()) {
    throw InputError(
        fmt::format("harmonics of {} readings at {} times", values.size(), times.size()));
  }
  if (angles.size() != values.size() || values.size() < 2 * orders.size() + 2) {
    throw InputError(fmt::format(
        "{} harmonics of {} angles and {} readings: they need at least {} of each; record longer",
        orders.size(), angles.size(), values.size(), 2 * orders.size() + 2));
  }
}

// Readings of one deviation, or with a memory.
estimation::Problem ShaftProblem(std::shared_ptr<const estimation::Residual> readings,
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
  problem.Add(problem.AddSource("readings"), std::move(readings), inputs, noise);
  return problem;
}

estimation::Result Solve(const estimation::Problem& problem) {
  estimation::Result result = problem.Solve();
  if (!result.Usable()) {
    throw NumericalError(
        fmt::format("harmonics of a shaft: {}; turn it by whole turns or ask for lower orders",
                    result.WhyNotUsable()));
  }
  return result;
}

Eigen::VectorXd Left(const BearingHarmonics& fit, std::span<const double> angles,
                     std::span<const double> values) {
  Eigen::VectorXd left(std::ssize(values));
  for (Index i = 0; i < left.size(); ++i) left[i] = values[i] - fit.At(angles[i]);
  return left;
}

// The factor by which sums of 2, 4, ... neighbouring residuals scatter more than those of independent
// ones, up to an eighth of a turn of the highest order: at least 1.
double Correlated(const BearingHarmonics& fit, std::span<const double> angles,
                  std::span<const double> values) {
  const Eigen::VectorXd left = Left(fit, angles, values);
  const auto [least, most] = std::ranges::minmax(angles);
  const int highest = fit.orders.empty() ? 1 : std::ranges::max(fit.orders);
  const double turns = highest * std::max(most - least, 1e-9) / (2.0 * std::numbers::pi);
  const auto longest = static_cast<Index>(static_cast<double>(left.size()) / (8.0 * turns));
  double factor = 1.0;
  for (Index length = 2; length <= longest; length *= 2) {
    double squares = 0.0;
    const Index sums = left.size() / length;
    for (Index k = 0; k < sums; ++k) {
      squares +=
          std::pow(left.segment(k * length, length).sum(), 2) / static_cast<double>(length * sums);
    }
    factor = std::max(factor, std::sqrt(squares) / fit.rms);
  }
  return factor;
}

std::optional<estimation::NoiseMemory> MemoryBeside(const estimation::Problem& problem,
                                                    const estimation::Result& result, double noise,
                                                    std::span<const double> times) {
  const estimation::Layout layout(problem);
  const Eigen::VectorXd x = ValuesFound(result, result.blocks);
  const RowMemory found =
      FindRowMemory(problem, layout, x, estimation::Linearize(problem, layout, x, 0), 0,
                    Eigen::Map<const Eigen::VectorXd>(times.data(), std::ssize(times)));
  if (!found.IsDrift()) return std::nullopt;
  return estimation::NoiseMemory{noise * found.noise.white, noise * found.noise.slow,
                                 found.noise.time};
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
                            const std::vector<int>& orders, std::span<const double> times) {
  Check(angles, values, orders, times);
  const Index n = values.size();
  Eigen::MatrixXd A(n, 1 + 2 * orders.size());
  for (Index i = 0; i < n; ++i) A.row(i) = Row(angles[i], orders);
  const double freedom = static_cast<double>(n - A.cols());
  const auto readings = std::make_shared<estimation::LinearResidual>(
      std::move(A), Eigen::Map<const Eigen::VectorXd>(values.data(), n));
  BearingHarmonics fit{orders, Solve(ShaftProblem(readings, orders, kLeastProbeNoise))};
  fit.rms = RmsAbout(fit, angles, values);
  // Again with the estimated noise, for the uncertainties.
  const double noise =
      std::max(fit.rms * std::sqrt(static_cast<double>(n) / freedom), kLeastProbeNoise);
  fit.result = Solve(ShaftProblem(readings, orders, noise));
  if (!times.empty()) {
    const double white =
        std::max(estimation::WhitePart({Left(fit, angles, values)}), kLeastProbeNoise);
    fit.memory = MemoryBeside(ShaftProblem(readings, orders, white), fit.result, white, times);
  }
  if (!fit.memory) {
    fit.correlated = Correlated(fit, angles, values);
    if (fit.correlated > 1.0)
      fit.result = Solve(ShaftProblem(readings, orders, noise * fit.correlated));
    return fit;
  }
  const Eigen::Map<const Eigen::VectorXd> time(times.data(), n);
  fit.result =
      Solve(ShaftProblem(simulation::WithMemory(readings, time, *fit.memory), orders, 1.0));
  fit.rms = RmsAbout(fit, angles, values);
  return fit;
}

double RmsAbout(const BearingHarmonics& fit, std::span<const double> angles,
                std::span<const double> values) {
  return std::sqrt(Left(fit, angles, values).squaredNorm() / static_cast<double>(values.size()));
}

}  // namespace abbe::fusion
