#include "fusion/plate_form.h"

#include <cmath>
#include <set>
#include <string>

namespace abbe::fusion {
namespace {

constexpr double kHolesOfPrior = 20.0;  // n
constexpr double kFormSeen = 4.0;       // standard deviations

bool IsHole(const estimation::ParameterBlock& block) {
  return block.name.starts_with("plate_hole ");
}

}  // namespace

PlateForm EstimatePlateForm(const estimation::Result& fit,
                            const std::vector<simulation::SimulatedRun>& runs, double times) {
  double squares = 0.0, told = 0.0, stated = 0.0, count = 0.0;
  std::set<std::string> seen;
  for (const auto& run : runs) {
    for (const auto& block : run.blocks) {
      if (!IsHole(block) || !seen.insert(block.name).second) continue;
      for (const auto& entry : fit.Block(block.name).entries) {
        squares += std::pow(entry.value / entry.prior_sd, 2);
        told += 1.0 - std::pow(entry.uncertainty / entry.prior_sd, 2);
        stated += std::pow(entry.prior_sd / times, 2);
        count += 1.0;
      }
    }
  }
  if (count == 0.0) return {};
  const double freedom = told + kHolesOfPrior;
  const double square = (times * times * squares + kHolesOfPrior) / freedom;
  const bool off = std::abs(square - 1.0) * std::sqrt(freedom / 2.0) > kFormSeen;
  return {off ? std::sqrt(square) : 1.0, std::sqrt(stated / count), 1.0 / std::sqrt(2.0 * freedom)};
}

void SetPlateForm(double times, double before, std::vector<simulation::SimulatedRun>& runs) {
  for (auto& run : runs) {
    for (auto& block : run.blocks) {
      if (!IsHole(block)) continue;
      for (auto& entry : block.entries) entry.prior_sd *= times / before;
    }
  }
}

}  // namespace abbe::fusion
