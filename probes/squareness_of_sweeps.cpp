#include "probes/squareness_of_sweeps.h"

#include <fmt/format.h>

#include <cmath>

#include "failure/failure.h"
#include "standards/squareness.h"

namespace abbe::probes {
namespace {

void RefuseUnlessComparable(const SweepResult& one, const SweepResult& other,
                            const TargetSettings& target) {
  const std::string both =
      fmt::format("{} and {}: no squareness: ", one.recording, other.recording);
  if (one.axis == other.axis) {
    throw InputError(
        fmt::format("{}both sweep the {} axis; give the sweeps of two axes", both, one.axis));
  }
  if (one.machine != other.machine) {
    throw InputError(
        fmt::format("{}they are of two machines, \"{}\" and \"{}\"; give two sweeps of one", both,
                    one.machine, other.machine));
  }
  for (const SweepResult* sweep : {&one, &other}) {
    if (sweep->mounting.empty()) {
      throw InputError(
          fmt::format("{}the header of {} does not state `mounting`; state the same mounting "
                      "in both if the target was not moved between them, else measure again",
                      both, sweep->recording));
    }
  }
  if (one.mounting != other.mounting) {
    throw InputError(
        fmt::format("{}the target was mounted anew between them ({} and {}), its tilt would "
                    "count as squareness; sweep both axes in one mounting",
                    both, one.mounting, other.mounting));
  }
  if (!(target.u_squareness > 0.0)) {
    throw InputError(
        fmt::format("{}the squareness of the target's faces is not known; state "
                    "target.squareness_urad and target.u_squareness_urad from its "
                    "certificate in the machine file",
                    both));
  }
}

const StraightnessFigures& StraightnessOf(const SweepResult& sweep, char direction) {
  const std::string name = fmt::format("E{}{}", direction, sweep.axis);
  for (const ComponentResult& component : sweep.components) {
    if (component.component.name == name) return component.straightness.value();
  }
  throw InputError(fmt::format("{}: has no {}", sweep.recording, name));
}

}  // namespace

SquarenessResult SquarenessOfSweeps(const SweepResult& one, const SweepResult& other,
                                    const TargetSettings& target) {
  RefuseUnlessComparable(one, other, target);
  const bool in_order = one.axis < other.axis;
  const SweepResult& first = in_order ? one : other;
  const SweepResult& second = in_order ? other : one;
  const StraightnessFigures& of_first = StraightnessOf(first, second.axis);
  const StraightnessFigures& of_second = StraightnessOf(second, first.axis);
  // Slopes over the travel of the carriage in M; the control may count the other way.
  const standards::Line a{.slope = first.sense * of_first.slope.value};
  const standards::Line b{.slope = second.sense * of_second.slope.value};
  SquarenessResult result{};
  if (second.axis == 'Y') {
    result.name = "C0Y";
    result.value = standards::SquarenessC0Y(a, b);
  } else if (first.axis == 'X') {
    result.name = "B0Z";
    result.value = standards::SquarenessB0Z(a, b);
  } else {
    result.name = "A0Z";
    result.value = standards::SquarenessA0Z(a, b);
  }
  result.value += target.squareness;
  result.u_slopes = std::hypot(of_first.slope.u, of_second.slope.u);
  result.u_target = target.u_squareness;
  result.u = std::hypot(result.u_slopes, result.u_target);
  return result;
}

}  // namespace abbe::probes
