// Random functions of one and of two coordinates: stationary Gaussian fields with the covariance
//
//   cov(f(p), f(q)) = sd^2 * exp(-(|p - q| / length)^2 / 2)
//
// Construction: a sum of Gaussian bells exp(-(|p - node| / length)^2) on a regular grid of nodes,
// each with an independent standard normal weight. The product of two bells is a Gaussian of their
// distance times a Gaussian of their middle, and the sum of the latter over a grid of step length/2
// is constant to 2 exp(-2 pi^2) = 5e-9 (Poisson summation); leaving out nodes farther than 4.5
// lengths costs 2e-9. So the field is exactly Gaussian, and its variance and covariance deviate
// from the formula by less than 1e-8 of sd^2 per coordinate. It is smooth and can be evaluated
// anywhere; the weight of a node is a pure function of (seed, stream, node).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "random/counter_random.h"

namespace abbe::rig {

// The bells of the nodes around a coordinate, in the order of the nodes.
struct BellWindow {
  static constexpr int kReach = 9;  // nodes to either side: 4.5 lengths
  static constexpr int kNodes = 2 * kReach + 1;
  std::int64_t first = 0;
  std::array<double, kNodes> bells{};

  BellWindow(double coordinate, double length);
};

// A random function of one coordinate. Nodes for [low, high] are kept; outside it the function is
// the same one, evaluated more slowly.
class GaussianProcess {
 public:
  GaussianProcess(const random::CounterRandom& random, double sd, double length, double low,
                  double high);

  double operator()(double coordinate) const { return At(BellWindow(coordinate, length_)); }
  // For several processes of one length at one coordinate.
  double At(const BellWindow& window) const;
  // Adds `share` of another process of the same length, for the coordinates that both keep.
  void Add(const GaussianProcess& more, double share);

 private:
  random::CounterRandom random_;
  double amplitude_;
  double length_;
  std::int64_t first_;
  std::vector<double> weights_;
};

// A random function of two coordinates; nodes for [low, high] x [low, high] are kept.
class GaussianSurface {
 public:
  GaussianSurface(const random::CounterRandom& random, double sd, double length, double low,
                  double high);

  double operator()(double a, double b) const;

 private:
  random::CounterRandom random_;
  double amplitude_;
  double length_;
  std::int64_t first_;
  std::int64_t count_;
  std::vector<double> weights_;
};

}  // namespace abbe::rig
