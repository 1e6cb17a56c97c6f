#include "compensation/corrector.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "failure/failure.h"

namespace abbe::compensation {
namespace {

using Eigen::Vector3d;

// m: the change in a step. The rest is the change times the slope of the error (<= 1e-3): 1e-15.
constexpr double kSettled = 1e-12;
constexpr int kMostSteps = 50;

}  // namespace

Corrector::Corrector(const machine::VolumetricModel& model, const Vector3d& p_TQ,
                     const Limits& limits)
    : field_(model),
      travels_(model.travels()),
      limits_(limits),
      p_TQ_(p_TQ),
      signs_(model.chain().ToolSenses()) {}

void Corrector::KeepZero(const Vector3d& zero) {
  zero_ = zero;
  at_zero_.setZero();
  at_zero_ = Offset(zero);
}

void Corrector::SetTool(const Vector3d& p_TQ) {
  p_TQ_ = p_TQ;
  if (zero_) KeepZero(*zero_);
}

Vector3d Corrector::InTravels(const Vector3d& position) const {
  Vector3d inside;
  for (int axis = 0; axis < 3; ++axis) {
    const machine::Travel& travel = travels_[axis];
    const machine::Travel& limit = limits_[axis];
    if (!(position[axis] >= limit.first && position[axis] <= limit.last)) {
      throw InputError(fmt::format(
          "{0} = {1:.9g} mm is beyond the soft limits, {2:.9g} to {3:.9g} mm, where the control "
          "would stop: keep away from the end of the travel (limit_mm in [axis.{0}] of the machine "
          "file are the limits that the control has)",
          "XYZ"[axis], 1e3 * position[axis], 1e3 * limit.first, 1e3 * limit.last));
    }
    inside[axis] = std::clamp(position[axis], travel.first, travel.last);
  }
  return inside;
}

Vector3d Corrector::MadeOfReading(const Vector3d& reading) const {
  constexpr double kWritten = 2e-9;  // m: a corrected program is rounded to 1e-7 inch
  const auto beyond = [](const machine::Travel& range, double at, double by) {
    return !(at >= range.first - by && at <= range.last + by);
  };
  for (int axis = 0; axis < 3; ++axis) {
    if (!beyond(limits_[axis], reading[axis], 0.0)) continue;
    machine::InTravel(travels_[axis], axis, reading[axis]);
  }
  const Vector3d made = Made(reading);
  for (int axis = 0; axis < 3; ++axis) {
    const machine::Travel& travel = travels_[axis];
    if (!beyond(travel, reading[axis], 0.0) || !beyond(travel, made[axis], kWritten)) continue;
    machine::InTravel(travel, axis, reading[axis]);
  }
  return made;
}

Vector3d Corrector::Command(const Vector3d& wanted) const {
  for (int axis = 0; axis < 3; ++axis) {
    machine::InTravel(travels_[axis], axis, wanted[axis]);
  }
  const Vector3d has = Vector3d(Has(0), Has(1), Has(2));
  Vector3d command = wanted - has.cwiseProduct(Offset(wanted));
  for (int step = 0; step < kMostSteps; ++step) {
    const Vector3d next = wanted - has.cwiseProduct(Offset(command));
    const double change = (next - command).cwiseAbs().maxCoeff();
    command = next;
    if (change >= kSettled) continue;
    InTravels(command);
    return command;
  }
  throw NumericalError(fmt::format(
      "no command found for X {:.6g} Y {:.6g} Z {:.6g} mm after {} steps; the errors of "
      "this map grow as fast as the position: check its units",
      1e3 * wanted.x(), 1e3 * wanted.y(), 1e3 * wanted.z(), kMostSteps));
}

double LineLength(const Corrector& corrector, const machine::VolumetricModel& model,
                  double tolerance) {
  constexpr int kStations = 60;
  Vector3d first, size;
  for (int k = 0; k < 3; ++k) {
    const machine::Travel& travel = model.travels()[k];
    first[k] = travel.first;
    size[k] = travel.last - travel.first;
  }
  const std::vector<std::pair<Vector3d, Vector3d>> lines = {
      {{0, .5, .5}, {1, .5, .5}}, {{.5, 0, .5}, {.5, 1, .5}}, {{.5, .5, 0}, {.5, .5, 1}},
      {{0, 0, 0}, {1, 1, 1}},     {{1, 0, 0}, {0, 1, 1}},     {{0, 1, 0}, {1, 0, 1}},
      {{0, 0, 1}, {1, 1, 0}}};
  double curvature = 0.0;
  for (const auto& [from, to] : lines) {
    const Vector3d a = first + size.cwiseProduct(from), b = first + size.cwiseProduct(to);
    const double h = (b - a).norm() / kStations;
    const auto offset = [&](int i) {
      const Vector3d p = a + (b - a) * (static_cast<double>(i) / kStations);
      return Vector3d(corrector.Made(p) - p);
    };
    for (int i = 1; i < kStations; ++i) {
      const Vector3d bend = offset(i - 1) - 2 * offset(i) + offset(i + 1);
      curvature = std::max(curvature, bend.norm() / (h * h));
    }
  }
  const double longest = size.maxCoeff();
  return curvature > 0.0 ? std::min(longest, std::sqrt(8 * tolerance / curvature)) : longest;
}

}  // namespace abbe::compensation
