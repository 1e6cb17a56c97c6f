// Errors, positions and chains for the tests of the volumetric error.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "machine/volumetric_error.h"
#include "random/counter_random.h"

namespace abbe::machine {

// All 24 chains of X, Y, Z with b in each place.
inline std::vector<Chain> AllChains() {
  std::vector<Chain> chains;
  for (const std::string order : {"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"}) {
    for (std::size_t bed = 0; bed <= 3; ++bed) {
      chains.push_back(Chain::Parse("[w" + order.substr(0, bed) + "b" + order.substr(bed) + "t]"));
    }
  }
  return chains;
}

// The same chains, each counted by the carriages and as the tool goes.
inline std::vector<Chain> AllCounts() {
  std::vector<Chain> chains = AllChains();
  for (Chain chain : AllChains()) {
    if (chain.workpiece_axes().empty()) continue;
    chain.SetPositive({Positive::kTool, Positive::kTool, Positive::kTool});
    chains.push_back(chain);
  }
  return chains;
}

// Numbers in [-1, 1], one after the other.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : random_(seed, 1) {}
  double Next() { return random_.Uniform(count_++, -1.0, 1.0); }
  Eigen::Vector3d Vector(double size) {
    const double x = Next(), y = Next(), z = Next();
    return size * Eigen::Vector3d(x, y, z);
  }
  MotionErrors<double> Errors(double translation, double angle) {
    MotionErrors<double> errors;
    for (auto& axis : errors.axes) {
      axis.head<3>() = Vector(translation);
      axis.tail<3>() = Vector(angle);
    }
    errors.squareness = Vector(angle);
    return errors;
  }

 private:
  random::CounterRandom random_;
  std::uint64_t count_ = 0;
};

// d error / d size at size 0, when all errors grow in proportion: the first-order error, exactly.
Eigen::Vector3d FirstOrderError(const Chain& chain, const Eigen::Vector3d& position,
                                const Eigen::Vector3d& p_TQ, const MotionErrors<double>& errors);

}  // namespace abbe::machine
