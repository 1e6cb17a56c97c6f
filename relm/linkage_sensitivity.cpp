#include "relm/linkage_sensitivity.h"

#include <fmt/format.h>

#include <cmath>
#include <span>

#include "failure/failure.h"
#include "random/counter_random.h"
#include "relm/nominal_angles.h"

namespace abbe::relm {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// A parameter that varies.
struct Varied {
  Index at;  // in x
  ParameterSensitivity sensitivity;
};

std::vector<Varied> VariedOf(const LinkageModel& model) {
  std::vector<Varied> varied;
  Index at = 0;
  for (const auto& block : model.blocks()) {
    for (std::size_t i = 0; i < block.entries.size(); ++i, ++at) {
      const estimation::Parameter& entry = block.entries[i];
      if (entry.held) continue;
      if (!std::isfinite(entry.prior_sd)) {
        throw InputError(fmt::format(
            "linkage: {} has no tolerance; state one in [linkage.tolerance]", block.FullName(i)));
      }
      varied.push_back({at, {block.FullName(i), block.unit, entry.prior_sd, 0, 0, {}}});
    }
  }
  return varied;
}

// Tip errors of all poses for deviations from the nominal parameters.
class TipErrors {
 public:
  TipErrors(const LinkageModel& model, const LinkageReadings& poses, bool displacement)
      : model_(model), poses_(poses), displacement_(displacement), nominal_(model.Values()) {
    model_.Tips(poses_, nominal_, nominal_tips_);
  }

  Matrix3Xd Of(const std::vector<Varied>& varied, std::span<const double> deviations) const {
    VectorXd x = nominal_;
    for (std::size_t i = 0; i < varied.size(); ++i) x[varied[i].at] += deviations[i];
    return Of(x);
  }
  Matrix3Xd OfOne(const Varied& varied) const {
    VectorXd x = nominal_;
    x[varied.at] += varied.sensitivity.tolerance;
    return Of(x);
  }

 private:
  Matrix3Xd Of(const VectorXd& x) const {
    Matrix3Xd tips;
    model_.Tips(poses_, x, tips);
    Matrix3Xd errors = tips - nominal_tips_;
    if (displacement_) errors.colwise() -= Vector3d(errors.col(0));
    return errors;
  }

  const LinkageModel& model_;
  const LinkageReadings& poses_;
  bool displacement_;
  VectorXd nominal_;
  Matrix3Xd nominal_tips_;
};

}  // namespace

LinkageReadings PosesInVolume(const LinkageSettings& settings, const SensitivityVolume& volume,
                              double warmth) {
  if (volume.points < 2 || !(volume.size.minCoeff() > 0) || !volume.size.allFinite()) {
    throw InputError(fmt::format(
        "linkage: a volume of {:g} x {:g} x {:g} mm with {} points an edge has no poses; give "
        "three lengths above 0 and at least 2 points",
        1e3 * volume.size.x(), 1e3 * volume.size.y(), 1e3 * volume.size.z(), volume.points));
  }
  const geometry::Transform<double> X_BM = settings.X_MB.Inverse();
  const int n = volume.points;
  LinkageReadings readings;
  readings.angles.resize(settings.chain.joints(), 1 + n * n * n);
  const VectorXd centre = NominalAngles(settings, X_BM * volume.centre);
  readings.angles.col(0) = centre;
  for (int i = 0; i < n * n * n; ++i) {
    const Vector3d step = Eigen::Vector3i(i % n, i / n % n, i / (n * n)).cast<double>() / (n - 1) -
                          Vector3d::Constant(0.5);
    const Vector3d p_MT = volume.centre + volume.size.cwiseProduct(step);
    readings.angles.col(1 + i) = NominalAngles(settings, X_BM * p_MT, centre);
  }
  readings.warmth.setConstant(readings.poses(), warmth);
  return readings;
}

LinkageSensitivity AnalyseSensitivity(const LinkageModel& model, const LinkageReadings& poses,
                                      const SensitivityOptions& options) {
  std::vector<Varied> varied = VariedOf(model);
  const TipErrors errors(model, poses, options.displacement);
  const auto draw = [&](std::uint64_t index, std::span<double> deviations) {
    for (std::size_t i = 0; i < varied.size(); ++i) {
      const random::CounterRandom random(options.seed, i);
      deviations[i] = varied[i].sensitivity.tolerance * random.Normal(index);
    }
  };
  const auto tip_errors = [&](std::span<const double> deviations, std::span<double> outputs) {
    Eigen::Map<Matrix3Xd>(outputs.data(), 3, poses.poses()) = errors.Of(varied, deviations);
  };
  const std::size_t outputs = 3 * poses.poses();
  const auto sobol = estimation::SobolIndices(varied.size(), outputs, draw, tip_errors,
                                              {.draws = options.draws, .threads = options.threads});
  // The first pose has no displacement.
  const double count = poses.poses() - (options.displacement ? 1 : 0);
  LinkageSensitivity result{std::sqrt(sobol.variance / count), {}};
  for (std::size_t i = 0; i < varied.size(); ++i) {
    const Matrix3Xd alone = errors.OfOne(varied[i]);
    ParameterSensitivity& sensitivity = varied[i].sensitivity;
    sensitivity.alone = alone.norm() / std::sqrt(count);
    sensitivity.worst = alone.colwise().norm().maxCoeff();
    sensitivity.share = sobol.inputs[i];
    result.parameters.push_back(sensitivity);
  }
  return result;
}

}  // namespace abbe::relm
