#include "probes/channel_noise.h"

#include <Eigen/Core>
#include <Eigen/QR>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "estimation/readings_at_rest.h"

namespace abbe::probes {
namespace {

constexpr double kByChance = 1e-3;

struct Sine {
  double amplitude = 0.0;
  double squares = std::numeric_limits<double>::infinity();  // of what is left
};

Sine SineOf(double hertz, const Eigen::VectorXd& times, const Eigen::VectorXd& values) {
  const Eigen::ArrayXd phase = 2.0 * std::numbers::pi * hertz * times.array();
  Eigen::MatrixXd terms(times.size(), 3);
  terms << Eigen::VectorXd::Ones(times.size()), phase.sin().matrix(), phase.cos().matrix();
  const auto solver = terms.colPivHouseholderQr();
  if (solver.rank() < 3) return {};
  const Eigen::Vector3d fit = Eigen::VectorXd(solver.solve(values));
  return {std::hypot(fit[1], fit[2]), (values - terms * fit).squaredNorm()};
}

}  // namespace

ChannelNoise NoiseOf(std::span<const double> times, std::span<const double> values) {
  std::vector<double> good_times, good;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    good_times.push_back(times[i] - times.front());
    good.push_back(values[i]);
  }
  ChannelNoise found{.readings = good.size()};
  if (good.empty()) {
    found.mean = std::numeric_limits<double>::quiet_NaN();
    return found;
  }
  const auto count = static_cast<Eigen::Index>(good.size());
  const Eigen::Map<const Eigen::VectorXd> all(good.data(), count);
  const Eigen::Map<const Eigen::VectorXd> at(good_times.data(), count);
  found.mean = all.mean();
  const Eigen::VectorXd deviation = all.array() - found.mean;
  found.constant = count > 1 && deviation.cwiseAbs().maxCoeff() == 0.0;
  const double n = static_cast<double>(count);
  found.noise = count > 1 ? std::sqrt(deviation.squaredNorm() / (n - 1.0)) : 0.0;
  if (count < 8 || found.constant) return found;
  for (const double hertz : estimation::kMains) {
    const Sine sine = SineOf(hertz, at, deviation);
    const double noise = std::sqrt(sine.squares / (n - 3.0));
    const double limit = noise * std::sqrt(-4.0 * std::log(kByChance) / n);
    if (!(sine.amplitude > limit) || noise >= found.noise) continue;
    found.noise = noise;
    found.mains = sine.amplitude;
    found.mains_hz = hertz;
  }
  return found;
}

}  // namespace abbe::probes
