// A calibrated linkage: the estimates that turn encoder readings into ball positions.
//
//   const Calibration calibration = ReadCalibration("linkage.toml", settings);
//   const CalibratedLinkage linkage(settings, calibration);
//   const Eigen::Matrix3Xd p_MT = linkage.Tips(readings);       // readings: relm/tip_path.h
//
// Where the calibration is mapped, the ball position of a pose is blended from the parameter sets
// of the cells around it: p = sum of w_c(p_global) p(readings; x_c), where the weights w_c are the
// trilinear ones of the grid of cell centres, clamped at its border. They are continuous and sum
// to 1, so the corrected path is continuous.
//
// Frames: M, the machine frame as the workpiece carries it (relm/linkage_settings.h); B, the base;
// T, the ball.
// Units: m, rad. Shapes: one column per pose.
// Failure: InputError when the calibration lacks the mounting or does not fit its model for the
// linkage of the machine file.
// Source: docs/theory-linkage.md; the blend of cells: Boelens (2006), fusion/mapping.h.
// Validity: inside the calibrated volume; outside it the uncertainty grows, which only
// StandardUncertainties shows.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "estimation/parameter.h"
#include "relm/linkage_settings.h"

namespace abbe::fusion {

// Local parameter sets on a grid of cell centres, in M; the index runs over z fastest, then y, x.
struct MappedParameters {
  std::array<std::vector<double>, 3> centres;  // m, ascending
  std::vector<Eigen::VectorXd> values;         // of the model's parameters, one set per centre
};

struct Calibration {
  std::string machine;  // name of the machine
  relm::ErrorModel model = relm::ErrorModel::kComplete;
  bool displacement = false;  // no prior for the base position
  std::vector<std::string> mountings;
  // "base" and "base_turn" of each mounting ("base NAME" for one with a name), then those of the
  // model; with values and uncertainties.
  std::vector<estimation::ParameterBlock> blocks;
  std::vector<std::string> names;  // of the free parameters
  Eigen::MatrixXd covariance;      // of the free parameters
  std::optional<MappedParameters> mapped;
  double held_out_rms = std::numeric_limits<double>::quiet_NaN();  // m, 3D
};

class CalibratedLinkage {
 public:
  CalibratedLinkage(const relm::LinkageSettings& settings, Calibration calibration);

  const Calibration& calibration() const { return calibration_; }
  const relm::LinkageModel& model() const { return model_; }
  // The base of a mounting. Unless `strict`, an unknown name gets the first base: displacements are
  // then still valid.
  geometry::Transform<double> X_MB(const std::string& mounting, bool strict = true) const;

  // p_MT of each pose.
  Eigen::Matrix3Xd Tips(const relm::LinkageReadings& readings, const std::string& mounting = "",
                        bool strict = true) const;
  // Standard uncertainty of each coordinate of Tips due to the calibration (global parameters),
  // without the noise of the readings.
  Eigen::Matrix3Xd StandardUncertainties(const relm::LinkageReadings& readings,
                                         const std::string& mounting = "") const;
  // The same uncertainty with the correlation of several sets of readings: [error][set] holds the
  // shifts of the tips by one standard deviation of one independent error of the calibration.
  // Largest first; errors that shift them by less than 1 nm (rms) are left out.
  std::vector<std::vector<Eigen::Matrix3Xd>> IndependentErrors(
      const std::vector<const relm::LinkageReadings*>& readings,
      const std::vector<std::string>& mountings) const;

 private:
  // d(x, y, z of each pose) / d(free parameters).
  Eigen::MatrixXd JacobianByFree(const relm::LinkageReadings& readings, const std::string& mounting,
                                 bool strict) const;
  std::size_t IndexOf(const std::string& mounting, bool strict) const;

  Calibration calibration_;
  relm::LinkageModel model_;
  geometry::Transform<double> nominal_X_MB_;
  std::vector<Eigen::VectorXd> x_;  // parameters of LinkageSimulation, for each mounting
};

}  // namespace abbe::fusion
