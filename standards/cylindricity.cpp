#include "standards/cylindricity.h"

#include <Eigen/QR>
#include <cmath>

#include "failure/failure.h"

namespace abbe::standards {

Cylindricity EvaluateCylindricity(const Eigen::Matrix3Xd& points) {
  if (points.cols() < 6 || !points.allFinite()) {
    throw InputError("a cylinder needs six points or more, all finite");
  }
  const Eigen::Vector3d mean = points.rowwise().mean();
  Cylindricity fit;
  fit.centre = mean.head<2>();
  fit.radius = (points.colwise() - mean).topRows<2>().colwise().norm().mean();
  Eigen::MatrixXd J(points.cols(), 5);
  Eigen::VectorXd deviations(points.cols());
  constexpr int kMostSteps = 30;
  for (int step = 0; step < kMostSteps; ++step) {
    // The distance to a tilted axis is that in its own cross-section.
    const Eigen::Vector3d axis = Eigen::Vector3d(fit.tilt.x(), fit.tilt.y(), 1.0).normalized();
    const Eigen::Vector3d foot(fit.centre.x(), fit.centre.y(), mean.z());
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
      const Eigen::Vector3d arm = points.col(i) - foot;
      const Eigen::Vector3d out = arm - axis * axis.dot(arm);
      const double distance = out.norm();
      const double u = out.x() / distance, v = out.y() / distance, h = arm.z();
      J.row(i) << -u, -v, -u * h, -v * h, -1.0;
      deviations[i] = distance - fit.radius;
    }
    const auto qr = J.colPivHouseholderQr();
    if (qr.rank() < 5)
      throw InputError("the points fix no cylinder: spread them in height and angle");
    const Eigen::VectorXd change = -qr.solve(deviations);
    fit.centre += change.head<2>();
    fit.tilt += change.segment<2>(2);
    fit.radius += change[4];
    if (change.norm() < 1e-13 * (1.0 + fit.radius)) {
      fit.error = deviations.maxCoeff() - deviations.minCoeff();
      return fit;
    }
  }
  throw NumericalError(
      "the least-squares cylinder did not settle; are the points near a cylinder along z?");
}

}  // namespace abbe::standards
