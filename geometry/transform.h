// Poses of one frame in another: rotation and position together.
//
// Frames: Transform X_AB is the pose of frame B seen from frame A. It carries coordinates from B to
// A, and the inner letters cancel:
//
//   X_AC = X_AB * X_BC;      p_AQ = X_AB * p_BQ;      X_BA = X_AB.Inverse();
//
// p_AQ is the point Q seen from A. The letters of the project: M machine reference, W work table,
// T tool point, H probe head, B linkage base, P pivot; X_MT = X_MW * X_WT reads by eye.
// Units: m and rad. Shapes: R 3x3, p 3x1.
// Failure: none; a value that is not finite passes through.
// Source: homogeneous transforms, e.g. Craig, "Introduction to Robotics", chapter 2; the error
// transform is the T of the five-probe head paper without its travel d, with the sign of its -EBX
// entry restored.
// Validity: Inverse() transposes R, so it is exact for a rotation; for a SmallErrorTransform, which
// is not a rotation, it neglects |angles|^2: solve with Matrix() where that matters.
#pragma once

#include <Eigen/Core>

#include "geometry/rotation.h"

namespace abbe::geometry {

template <typename T>
struct Transform {
  Eigen::Matrix3<T> R = Eigen::Matrix3<T>::Identity();
  Eigen::Vector3<T> p = Eigen::Vector3<T>::Zero();

  Transform Inverse() const {
    const Eigen::Matrix3<T> back = R.transpose();
    return {back, -(back * p)};
  }

  // The 4x4 homogeneous matrix.
  Eigen::Matrix4<T> Matrix() const {
    Eigen::Matrix4<T> X = Eigen::Matrix4<T>::Identity();
    X.template topLeftCorner<3, 3>() = R;
    X.template topRightCorner<3, 1>() = p;
    return X;
  }

  template <typename U>
  Transform<U> Cast() const {
    return {R.template cast<U>(), p.template cast<U>()};
  }

  friend Transform operator*(const Transform& X_AB, const Transform& X_BC) {
    return {X_AB.R * X_BC.R, X_AB.R * X_BC.p + X_AB.p};
  }

  friend Eigen::Vector3<T> operator*(const Transform& X_AB, const Eigen::Vector3<T>& p_BQ) {
    return X_AB.R * p_BQ + X_AB.p;
  }
};

template <typename T>
using ErrorVector = Eigen::Matrix<T, 6, 1>;  // [EXX EYX EZX EAX EBX ECX], m then rad

// The pose of a moved body in its nominal frame, to first order in its six errors.
template <typename T>
Transform<T> SmallErrorTransform(const ErrorVector<T>& errors) {
  return {SmallRotation<T>(errors.template tail<3>()), errors.template head<3>()};
}

// The same with the full rotation exp([EAX EBX ECX]), which does not depend on an order of the
// angles.
template <typename T>
Transform<T> ErrorTransform(const ErrorVector<T>& errors) {
  return {ExpRotation<T>(errors.template tail<3>()), errors.template head<3>()};
}

}  // namespace abbe::geometry
