#include "paths/circle_noise.h"

#include <cmath>

#include "random/counter_random.h"

namespace abbe::paths {
namespace {

constexpr double kSquares = 20.0;  // of the coefficients 1, -3, 3, -1
constexpr std::uint64_t kSeed = 1;

bool InSequence(const CirclePoint* four) {
  for (int i = 1; i < 4; ++i) {
    if (four[i].sense != four[0].sense || four[i].pass != four[0].pass) return false;
  }
  return true;
}

double Radius(const CirclePoint& point) { return std::hypot(point.first, point.second); }

}  // namespace

double ReadingNoise(const CircleRun& run) {
  double squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i + 3 < run.points.size(); ++i) {
    const CirclePoint* four = &run.points[i];
    if (!InSequence(four)) continue;
    const double difference =
        Radius(four[0]) - Radius(four[3]) + 3.0 * (Radius(four[2]) - Radius(four[1]));
    squares += difference * difference;
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(squares / count / kSquares) : 0.0;
}

CircleRun WithNoise(const CircleRun& run, double deviation, std::uint64_t copy) {
  const random::CounterRandom noise(kSeed, copy);
  CircleRun noisy = run;
  std::uint64_t draw = 0;
  for (CirclePoint& point : noisy.points) {
    const double radius = Radius(point);
    const double part = radius > 0.0 ? deviation * noise.Normal(draw) / radius : 0.0;
    point.first += part * point.first;
    point.second += part * point.second;
    point.third += deviation * noise.Normal(draw + 1);
    draw += 2;
  }
  return noisy;
}

}  // namespace abbe::paths
