#include "fusion/doubted_calibration.h"

#include <algorithm>
#include <cmath>

#include "failure/failure.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using estimation::ParameterBlock;

// Does something with each entry that is one of the free parameters, and with its index.
template <typename Blocks, typename Use>
void ForFree(Blocks& blocks, const std::vector<std::string>& names, const Use& use) {
  for (auto& block : blocks) {
    for (std::size_t i = 0; i < block.entries.size(); ++i) {
      const auto at = std::find(names.begin(), names.end(), block.FullName(i));
      if (at != names.end()) use(block.entries[i], at - names.begin());
    }
  }
}

Eigen::VectorXd FreeValues(const Calibration& calibration) {
  Eigen::VectorXd values(calibration.names.size());
  ForFree(calibration.blocks, calibration.names,
          [&](const auto& entry, Index at) { values[at] = entry.value; });
  return values;
}

// Variance of the ball, m^2: mean over all poses and coordinates.
double MeanVariance(const Calibration& calibration, const std::vector<simulation::LinkageRun>& runs,
                    const relm::LinkageSettings& settings) {
  const CalibratedLinkage linkage(settings, calibration);
  double squares = 0.0, count = 0.0;
  for (const simulation::LinkageRun& run : runs) {
    const auto u = linkage.StandardUncertainties(run.readings, run.mounting);
    squares += u.squaredNorm();
    count += u.size();
  }
  return squares / count;
}

}  // namespace

void AddDoubt(const CalibrationReport& without, double unexplained,
              const std::vector<simulation::LinkageRun>& runs,
              const relm::LinkageSettings& settings, CalibrationReport& report) {
  Calibration& calibration = report.calibration;
  if (calibration.names != without.calibration.names) {
    throw InputError("calibrations of other parameters cannot be held against each other");
  }
  const Eigen::VectorXd change = FreeValues(calibration) - FreeValues(without.calibration);
  const double variance = MeanVariance(calibration, runs, settings);
  calibration.covariance *= 1.0 + unexplained * unexplained / variance;
  calibration.covariance += change * change.transpose();
  report.fit.covariance = calibration.covariance;
  for (auto* blocks : {&calibration.blocks, &report.fit.blocks}) {
    ForFree(*blocks, calibration.names, [&](auto& entry, Index at) {
      entry.uncertainty = std::sqrt(calibration.covariance(at, at));
    });
  }
}

}  // namespace abbe::fusion
