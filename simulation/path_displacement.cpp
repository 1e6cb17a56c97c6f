#include "simulation/path_displacement.h"

#include "simulation/correction_steps.h"

namespace abbe::simulation {

using Eigen::Index;

namespace {

constexpr double kStop = 1.0;  // s

Trace TraceOf(const Eigen::Matrix3Xd& path, double feed) {
  Trace trace;
  const std::size_t rows = path.cols();
  trace.pass.assign(rows, 1);
  trace.direction.assign(rows, 1);
  trace.time = Eigen::VectorXd::Zero(path.cols());
  for (Index row = 1; row < path.cols(); ++row) {
    const double way = (path.col(row) - path.col(row - 1)).norm();
    trace.time[row] = trace.time[row - 1] + (feed > 0.0 ? way / feed : kStop);
  }
  trace.clock = trace.time;
  trace.SetAxes(path);
  return trace;
}

}  // namespace

bool ActsOnPath(const ModelledCause& cause) {
  return cause.cause->CorrectedAt(cause.object) == CorrectedBy::kMotion &&
         cause.object.IsOfAxes() && cause.cause->follows == Follows::kPath &&
         !cause.cause->IsRandomField();
}

Eigen::Matrix3Xd PathDisplacement(const Eigen::Matrix3Xd& path, double feed,
                                  const std::vector<ModelledCause>& causes) {
  Trace trace = TraceOf(path, feed);
  std::vector<ModelledCause> acting;
  for (const ModelledCause& each : causes) {
    if (ActsOnPath(each)) acting.push_back(each);
  }
  const Sums sums = SumsOf(trace, acting, {});
  Eigen::Matrix3Xd displaced(3, path.cols());
  for (int axis = 0; axis < 3; ++axis) displaced.row(axis) = sums.machine.row(Positioning(axis));
  return displaced;
}

}  // namespace abbe::simulation
