// The linkage a second time, as plain products of 4 x 4 matrices written out by hand: what the
// tests of relm/ compare with. Shares no code with relm/ but the names of the parameters. T is any
// scalar, so that a Jet gives exact derivatives.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <map>
#include <string>
#include <string_view>

#include "relm/linkage_settings.h"
#include "settings/document.h"

namespace abbe::relm {

// Links of unequal length, so that no term hides behind another.
inline constexpr double kLink1 = 0.130, kLink2 = 0.110;  // m
inline constexpr std::string_view kLinkageText = R"(
[linkage]
form = "pivots"
link_1_mm = 130
link_2_mm = 110
[linkage.base]
position_mm = [-180, -30, -30]
)";

inline LinkageSettings LinkageFrom(std::string_view text) {
  return ReadLinkageSettings(settings::Document::Parse(text, "linkage.toml").Root());
}
inline LinkageSettings TestLinkage() { return LinkageFrom(kLinkageText); }

template <typename T>
using Matrix4 = Eigen::Matrix<T, 4, 4>;

template <typename T>
Matrix4<T> MoveBy(const T& x, const T& y, const T& z) {
  Matrix4<T> X = Matrix4<T>::Identity();
  X(0, 3) = x, X(1, 3) = y, X(2, 3) = z;
  return X;
}

template <typename T>
Matrix4<T> TurnX(const T& a) {
  using std::cos, std::sin;
  Matrix4<T> X = Matrix4<T>::Identity();
  X(1, 1) = cos(a), X(1, 2) = -sin(a), X(2, 1) = sin(a), X(2, 2) = cos(a);
  return X;
}

template <typename T>
Matrix4<T> TurnY(const T& a) {
  using std::cos, std::sin;
  Matrix4<T> X = Matrix4<T>::Identity();
  X(0, 0) = cos(a), X(0, 2) = sin(a), X(2, 0) = -sin(a), X(2, 2) = cos(a);
  return X;
}

template <typename T>
Matrix4<T> TurnZ(const T& a) {
  using std::cos, std::sin;
  Matrix4<T> X = Matrix4<T>::Identity();
  X(0, 0) = cos(a), X(0, 1) = -sin(a), X(1, 0) = sin(a), X(1, 1) = cos(a);
  return X;
}

template <typename T>
Eigen::Matrix<T, 3, 1> PositionOf(const Matrix4<T>& X) {
  return X.template topRightCorner<3, 1>();
}

// The parameters of a model by name.
template <typename T>
using Named = std::map<std::string, T>;

// The errors of the RELM paper.
template <typename T>
Eigen::Matrix<T, 3, 1> PivotTipByMatrices(const T* q, const T&, const Named<T>& x) {
  const T o(0);
  return PositionOf<T>(
      TurnX<T>(x.at("tilt.pivot_1_x")) * TurnY<T>(x.at("tilt.pivot_1_y")) *
      TurnZ<T>(q[0] + x.at("encoder_offset.pivot_1")) * TurnX<T>(x.at("twist.pivot_2")) *
      MoveBy<T>(x.at("divergence.pivot_2_x"), x.at("divergence.pivot_2_y"), o) *
      TurnY<T>(q[1] + x.at("encoder_offset.pivot_2")) * MoveBy<T>(x.at("link.link_1"), o, o) *
      TurnX<T>(x.at("twist.link_1")) * TurnY<T>(q[2] + x.at("encoder_offset.pivot_3")) *
      MoveBy<T>(o, o, x.at("link.link_2")));
}

// The run-out of a pivot: C1 sin q + C2 cos q + C3 sin 2q + C4 cos 2q.
template <typename T>
T RunOut(const Named<T>& x, const std::string& pivot, const T& q) {
  using std::cos, std::sin;
  const auto named = [&](const char* end) {
    const auto found = x.find("bearing." + pivot + end);
    return found == x.end() ? T(0) : found->second;
  };
  return named("_sin_1") * sin(q) + named("_cos_1") * cos(q) + named("_sin_2") * sin(T(2) * q) +
         named("_cos_2") * cos(T(2) * q);
}

// The 24 of Boelens (2006) on the six segments of the shipped linkage; without the entries of
// "bearing" its 12.
template <typename T>
Eigen::Matrix<T, 3, 1> PublishedTipByMatrices(const T* q, const T&, const Named<T>& x) {
  const T o(0), right(M_PI / 2);
  const auto segment = [&](const T& length) { return MoveBy<T>(o, o, length); };
  return PositionOf<T>(
      TurnX<T>(x.at("tilt.head_x")) * TurnY<T>(x.at("tilt.head_y")) *
      TurnZ<T>(q[0] + x.at("radial_angle.pivot_1")) * TurnY<T>(right) *
      segment(x.at("link.segment_1") + RunOut<T>(x, "pivot_1", q[0])) *
      TurnZ<T>(x.at("radial_angle.pivot_2_twist")) * TurnY<T>(q[1] + x.at("radial_angle.pivot_2")) *
      segment(x.at("link.segment_2") + RunOut<T>(x, "pivot_2", q[1])) *
      TurnZ<T>(x.at("radial_angle.pivot_3_twist")) * TurnY<T>(-right) *
      segment(x.at("link.segment_3")) * TurnY<T>(q[2] + x.at("radial_angle.pivot_3")) *
      segment(x.at("link.segment_4") + RunOut<T>(x, "pivot_3", q[2])) * TurnZ<T>(right) *
      TurnY<T>(right) * segment(x.at("link.segment_5")));
}

// Every motion of every axis, and the encoders, bearings, gravity and warmth.
template <typename T>
class CompleteByMatrices {
 public:
  CompleteByMatrices(const T* q, const T& warmth, const Named<T>& x)
      : q_(q), warmth_(warmth), x_(x) {}

  Eigen::Matrix<T, 3, 1> Tip() const {
    using std::cos, std::sin;
    const T o(0), lean_2 = cos(q_[1]), lean_3 = sin(q_[1] + q_[2]);
    // Pivot 1 stands upright, u = x, v = y.
    const Matrix4<T> pivot_1 = TurnX<T>(At("tilt.pivot_1_u")) * TurnY<T>(At("tilt.pivot_1_v")) *
                               MoveBy<T>(Shift("pivot_1", "u", 0), Shift("pivot_1", "v", 0), o) *
                               TurnZ<T>(Angle("pivot_1", 0));
    // Pivots 2 and 3 lie along y, u = x, v = y x x = -z. Gravity turns them towards +q: link 1
    // (cos q2, 0, -sin q2) sinks with the rate cos q2, link 2 with sin(q2 + q3).
    const Matrix4<T> pivot_2 = Horizontal("pivot_2", 1) *
                               TurnY<T>(Angle("pivot_2", 1) + At("compliance.pivot_2") * lean_2) *
                               MoveBy<T>(kLink1 + Grown("expansion.after_pivot_2", kLink1), o, o);
    const Matrix4<T> pivot_3 = Horizontal("pivot_3", 2) *
                               TurnY<T>(Angle("pivot_3", 2) + At("compliance.pivot_3") * lean_3) *
                               MoveBy<T>(o, o, kLink2 + Grown("expansion.after_pivot_3", kLink2));
    return PositionOf<T>(pivot_1 * pivot_2 * pivot_3 *
                         MoveBy<T>(At("ball.across"), At("ball.axial"), At("ball.along")));
  }

 private:
  const T& At(const std::string& name) const { return x_.at(name); }
  T Angle(const std::string& pivot, int joint) const {
    using std::cos, std::sin;
    const T& q = q_[joint];
    return q + At("encoder_offset." + pivot) + At("eccentricity." + pivot + "_sin_1") * sin(q) +
           At("eccentricity." + pivot + "_cos_1") * cos(q) +
           At("graduation." + pivot + "_sin_2") * sin(T(2) * q) +
           At("graduation." + pivot + "_cos_2") * cos(T(2) * q) +
           At("graduation." + pivot + "_sin_3") * sin(T(3) * q) +
           At("graduation." + pivot + "_cos_3") * cos(T(3) * q);
  }
  // The axis, with the run-out of its bearing.
  T Shift(const std::string& pivot, const std::string& direction, int joint) const {
    return At("shift." + pivot + "_" + direction) +
           RunOut<T>(x_, pivot + "_" + direction, q_[joint]);
  }
  Matrix4<T> Horizontal(const std::string& pivot, int joint) const {
    return TurnX<T>(At("tilt." + pivot + "_u")) * TurnZ<T>(-At("tilt." + pivot + "_v")) *
           MoveBy<T>(Shift(pivot, "u", joint), T(0), -Shift(pivot, "v", joint));
  }
  T Grown(const std::string& name, double length) const { return At(name) * length * warmth_; }

  const T* q_;
  const T& warmth_;
  const Named<T>& x_;
};

template <typename T>
Eigen::Matrix<T, 3, 1> CompleteTipByMatrices(const T* q, const T& warmth, const Named<T>& x) {
  return CompleteByMatrices<T>(q, warmth, x).Tip();
}

}  // namespace abbe::relm
