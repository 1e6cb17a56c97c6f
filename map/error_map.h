// The error map of a machine: the volumetric error at every point, its uncertainty, and the runs
// that determined it.
//
//   const ErrorMap map = ReadMap("out/map.toml");
//   const Eigen::Vector3d error = map.Error({0.03, 0.02, 0.05}, map.origin().tool);
//   const Eigen::Matrix3d cov_ee = map.Covariance({0.03, 0.02, 0.05}, map.origin().tool);
//
// Frames: error is p_WQ - nominal along the axes of the workpiece frame W
// (machine/volumetric_error.h); position is [X Y Z] as the axes are commanded; p_TQ is the tool
// point from the reference point.
// Units: SI. Shapes: the covariance of the parameters is P x P in the order of
// VolumetricModel::Parameters(); 0 x 0 for a map that states no uncertainty, as an imported one.
// Failure: InputError for a position outside the travels (nothing is extrapolated); for a
// covariance of another size, not symmetric, not finite or with a negative variance; for a request
// of the uncertainty of a map without one.
// Source: GUM (2008) 5.2.2, first order: cov_ee = J cov_pp J^T.
// Validity: first order in the parameters over their uncertainty; with turns below 1 mrad this
// neglects 1e-3 of it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "machine/volumetric_model.h"
#include "map/map_state.h"

namespace abbe::map {

// The source of an error that no run determines; else it is the kind of run that determines the
// error best, "sweep".
inline constexpr std::string_view kPriorOnly = "prior";

// The 21 errors: 18 motions in the order of machine/error_motion.h, then A0Z, B0Z, C0Y.
inline constexpr int kErrors = machine::kAxes * machine::kMotions + 3;
// "EXX" ... "C0Y"; InputError for a number outside 0 ... kErrors - 1.
std::string ErrorName(int error);
// The number of an error; -1 for an unknown name.
int ErrorNamed(std::string_view name);

// Origin of a map: machine, conditions and sources.
struct MapOrigin {
  std::string machine;
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();   // m, in M, with all axes at zero
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();        // p_TQ of the measurement, m
  double temperature = 20.0;                             // of the machine, degC
  std::optional<std::array<machine::Travel, 3>> limits;  // the soft limits, if known
  // Whether a calibrated length or scale was used; if not, the isotropic scale is that of the
  // prior.
  bool scale_is_calibrated = false;
  // Empty: kPriorOnly.
  std::array<std::string, kErrors> sources = {};

  std::string_view SourceOf(int error) const {
    const std::string& source = sources[static_cast<std::size_t>(error)];
    return source.empty() ? kPriorOnly : std::string_view(source);
  }
};

class ErrorMap {
 public:
  ErrorMap(MapOrigin origin, machine::VolumetricModel model, Eigen::MatrixXd cov_pp,
           std::optional<MapState> state = {});

  const MapOrigin& origin() const { return origin_; }
  const machine::VolumetricModel& model() const { return model_; }
  const Eigen::MatrixXd& cov_pp() const { return cov_pp_; }
  // For a map that is kept current (map_state.h); none: it was made once.
  const std::optional<MapState>& state() const { return state_; }
  // An imported map does not.
  bool StatesUncertainty() const { return cov_pp_.size() > 0; }
  // "EXX.c0" ... "squareness.C0Y", in the order of the parameters.
  std::vector<std::string> ParameterNames() const;
  // "calibrated" or "prior only".
  std::string_view Scale() const;
  // The soft limits; if unknown, the travels widened by kBeyondTravel.
  std::array<machine::Travel, 3> Limits() const;

  // Actual minus nominal in W, m.
  Eigen::Vector3d Error(const Eigen::Vector3d& position, const Eigen::Vector3d& p_TQ) const {
    return model_.Error(position, p_TQ);
  }
  // cov_ee of the three components, m^2.
  Eigen::Matrix3d Covariance(const Eigen::Vector3d& position, const Eigen::Vector3d& p_TQ) const;
  // The square roots of its diagonal, m.
  Eigen::Vector3d StandardUncertainty(const Eigen::Vector3d& position,
                                      const Eigen::Vector3d& p_TQ) const;

  // One of the 21 errors at positions of its axis, with its standard uncertainty; a squareness is
  // constant.
  struct Curve {
    Eigen::VectorXd value, u;  // m or rad
  };
  // InputError for an error outside 0 ... kErrors - 1.
  Curve CurveOf(int error, const Eigen::VectorXd& positions) const;

 private:
  MapOrigin origin_;
  machine::VolumetricModel model_;
  Eigen::MatrixXd cov_pp_;
  std::optional<MapState> state_;
};

}  // namespace abbe::map
