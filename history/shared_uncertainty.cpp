#include "history/shared_uncertainty.h"

#include <algorithm>
#include <cmath>

namespace abbe::history {
namespace {

bool IsSame(const std::string& role, const Instruments& one, const Instruments& other) {
  const auto first = one.find(role), second = other.find(role);
  return first != one.end() && second != other.end() && first->second == second->second;
}

double ShareOf(const Shares& shares, const std::string& role) {
  const auto share = shares.find(role);
  return share == shares.end() ? 0.0 : share->second;
}

}  // namespace

bool IsShared(const std::string& role, const Instruments& one, const Instruments& other) {
  if (role == "head" || role == "target" || role == "mounting") {
    if (!IsSame("mounting", one, other)) return false;
    if (role == "head") return IsSame("head", one, other) || IsSame("serial", one, other);
  }
  return IsSame(role, one, other);
}

double OfDifference(double u, const Shares& of_u, double v, const Shares& of_v,
                    const Instruments& one, const Instruments& other) {
  double variance = u * u + v * v;
  for (const auto& [role, share] : of_u) {
    if (!IsShared(role, one, other)) continue;
    variance -= 2.0 * u * std::sqrt(share) * v * std::sqrt(ShareOf(of_v, role));
  }
  return std::sqrt(std::max(variance, 0.0));
}

}  // namespace abbe::history
