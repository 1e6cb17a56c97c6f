// Rotations in space as matrices: exact, and linearised for small angles.
//
// Frames: R_AB holds the axes of frame B as its columns, written in frame A, so that
// v_A = R_AB * v_B and R_AC = R_AB * R_BC. Angles follow the right-hand rule.
// Units: rad. Shapes: vectors 3x1, matrices 3x3.
// Failure: none; a value that is not finite passes through.
// Source: Rodrigues' formula and its inverse by the unit quaternion, as in Sola, Deray, Atchuthan,
// "A micro Lie theory" (2018), equations 143, 145, 146 and 105.
// Validity: any angle for the exact functions; SmallRotation neglects |angles|^2 / 2, that is
// 0.5e-6 at 1 mrad, and is not orthogonal.
//
// Every function accepts any scalar of Eigen, in particular ceres::Jet: the derivatives are right
// at zero angle too, where a plain sqrt would divide by zero.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace abbe::geometry {

// Rotations by `angle` about the axes x, y and z.
template <typename T>
Eigen::Matrix3<T> RotationX(const T& angle) {
  using std::cos, std::sin;
  const T c = cos(angle), s = sin(angle);
  Eigen::Matrix3<T> R;
  R << T(1), T(0), T(0), T(0), c, -s, T(0), s, c;
  return R;
}

template <typename T>
Eigen::Matrix3<T> RotationY(const T& angle) {
  using std::cos, std::sin;
  const T c = cos(angle), s = sin(angle);
  Eigen::Matrix3<T> R;
  R << c, T(0), s, T(0), T(1), T(0), -s, T(0), c;
  return R;
}

template <typename T>
Eigen::Matrix3<T> RotationZ(const T& angle) {
  using std::cos, std::sin;
  const T c = cos(angle), s = sin(angle);
  Eigen::Matrix3<T> R;
  R << c, -s, T(0), s, c, T(0), T(0), T(0), T(1);
  return R;
}

// R = Rz(yaw) Ry(pitch) Rx(roll): first the roll about x, then pitch and yaw about the fixed axes.
template <typename T>
Eigen::Matrix3<T> RotationFromRollPitchYaw(const T& roll, const T& pitch, const T& yaw) {
  return RotationZ(yaw) * RotationY(pitch) * RotationX(roll);
}

// The matrix of the cross product: Skew(a) * b = a x b.
template <typename T>
Eigen::Matrix3<T> Skew(const Eigen::Vector3<T>& a) {
  Eigen::Matrix3<T> S;
  S << T(0), -a.z(), a.y(), a.z(), T(0), -a.x(), -a.y(), a.x(), T(0);
  return S;
}

// I + Skew(angles): the rotation to first order.
template <typename T>
Eigen::Matrix3<T> SmallRotation(const Eigen::Vector3<T>& angles) {
  return Eigen::Matrix3<T>::Identity() + Skew<T>(angles);
}

// The rotation by |rotation_vector| about the axis rotation_vector.
template <typename T>
Eigen::Matrix3<T> ExpRotation(const Eigen::Vector3<T>& rotation_vector) {
  using std::cos, std::sin, std::sqrt;
  const T square = rotation_vector.squaredNorm();
  T sine, versine;         // sin(a)/a and (1 - cos(a))/a^2
  if (square < T(1e-4)) {  // the series neglects a^8/9! < 3e-22
    sine = T(1) - square / T(6) * (T(1) - square / T(20) * (T(1) - square / T(42)));
    versine = T(0.5) - square / T(24) * (T(1) - square / T(30) * (T(1) - square / T(56)));
  } else {
    const T angle = sqrt(square);
    const T half = sin(angle / T(2));
    sine = sin(angle) / angle;
    versine = T(2) * half * half / square;
  }
  const Eigen::Matrix3<T> S = Skew<T>(rotation_vector);
  return Eigen::Matrix3<T>::Identity() + sine * S + versine * S * S;
}

// The left Jacobian of ExpRotation, "A micro Lie theory" equation 145: to first order in d,
// ExpRotation(v + d) = ExpRotation(Jacobian(v) d) ExpRotation(v).
template <typename T>
Eigen::Matrix3<T> ExpRotationJacobian(const Eigen::Vector3<T>& rotation_vector) {
  using std::cos, std::sin, std::sqrt;
  const T square = rotation_vector.squaredNorm();
  T versine, rest;         // (1 - cos(a))/a^2 and (a - sin(a))/a^3
  if (square < T(1e-4)) {  // the series neglects a^8/10! < 3e-23
    versine = T(0.5) - square / T(24) * (T(1) - square / T(30) * (T(1) - square / T(56)));
    rest = T(1) / T(6) - square / T(120) * (T(1) - square / T(42) * (T(1) - square / T(72)));
  } else {
    const T angle = sqrt(square);
    const T half = sin(angle / T(2));
    versine = T(2) * half * half / square;
    rest = (angle - sin(angle)) / (square * angle);
  }
  const Eigen::Matrix3<T> S = Skew<T>(rotation_vector);
  return Eigen::Matrix3<T>::Identity() + versine * S + rest * S * S;
}

// The rotation vector of R, of length at most pi. At exactly pi either sign is right.
template <typename T>
Eigen::Vector3<T> LogRotation(const Eigen::Matrix3<T>& R) {
  using std::atan2, std::sqrt;
  Eigen::Quaternion<T> q(R);  // (cos(a/2), sin(a/2) axis)
  if (q.w() < T(0)) q.coeffs() = -q.coeffs();
  const T square = q.vec().squaredNorm();
  if (square < T(1e-4)) {  // 2 asin(s)/s, neglecting 0.06 s^8 < 1e-17
    return q.vec() *
           (T(2) + square * (T(1) / T(3) + square * (T(3) / T(20) + square * T(5) / T(56))));
  }
  const T sine = sqrt(square);
  return q.vec() * (T(2) * atan2(sine, q.w()) / sine);
}

}  // namespace abbe::geometry
