#include "map/axis_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "failure/failure.h"

namespace abbe::map {
namespace {

using machine::kAxes;
using machine::kMotions;

// What rounding in a file leaves of a gauge that held: 1e-12 m or rad.
constexpr double kNothing = 1e-12;

machine::Travel TravelOf(const AxisTables& tables, int axis) {
  machine::Travel travel{-std::numeric_limits<double>::infinity(),
                         std::numeric_limits<double>::infinity()};
  for (int motion = 0; motion < kMotions; ++motion) {
    const auto& positions =
        tables.errors[static_cast<std::size_t>(kMotions * axis + motion)].positions;
    if (positions.empty()) continue;
    travel.first = std::max(travel.first, positions.front());
    travel.last = std::min(travel.last, positions.back());
  }
  if (!std::isfinite(travel.first) || !(travel.first < travel.last)) {
    throw InputError(
        fmt::format("the file holds no errors of {} over a travel; a map needs all "
                    "three axes, zeros too",
                    "XYZ"[axis]));
  }
  return travel;
}

// d squareness [A0Z B0Z C0Y] / d slope of a straightness, standards/squareness.h; zero for the
// others.
Eigen::Vector3d SquarenessOfSlope(int axis, int motion) {
  const std::string name = machine::MotionName(axis, motion);
  if (name == "EZY" || name == "EYZ") return {-1.0, 0.0, 0.0};
  if (name == "EZX" || name == "EXZ") return {0.0, 1.0, 0.0};
  if (name == "EYX" || name == "EXY") return {0.0, 0.0, -1.0};
  return Eigen::Vector3d::Zero();
}

}  // namespace

double TableUnit(int error) { return error < kErrors - 3 && error % kMotions < 3 ? 1e-3 : 1.0; }

AxisTables Tabulate(const ErrorMap& map, const Eigen::Vector3d& p_TQ,
                    const std::array<Eigen::Index, 3>& counts) {
  AxisTables tables;
  tables.header = HeaderOf(map, p_TQ);
  tables.squareness = map.model().squareness();
  for (int axis = 0; axis < kAxes; ++axis) {
    const machine::Travel& travel = map.model().travels()[static_cast<std::size_t>(axis)];
    const auto count = counts[static_cast<std::size_t>(axis)];
    if (count < 2)
      throw InputError(fmt::format("{} points along an axis: give two or more", count));
    for (int motion = 0; motion < kMotions; ++motion) {
      ErrorTable& table = tables.errors[static_cast<std::size_t>(kMotions * axis + motion)];
      for (Eigen::Index i = 0; i < count; ++i) {
        const double along = static_cast<double>(i) / static_cast<double>(count - 1);
        table.positions.push_back(
            i == count - 1 ? travel.last : travel.first + along * (travel.last - travel.first));
        table.values.push_back(map.model().Function(axis, motion).Evaluate(table.positions.back()));
      }
    }
  }
  return tables;
}

ImportedMap MapOfTables(const AxisTables& tables) {
  if (tables.header.chain.empty()) {
    throw InputError(
        "the file does not say the order of the axes; give it with --chain \"[w X Y b Z t]\"");
  }
  std::array<machine::Travel, kAxes> travels;
  for (int axis = 0; axis < kAxes; ++axis)
    travels[static_cast<std::size_t>(axis)] = TravelOf(tables, axis);
  machine::VolumetricModel model(machine::Chain::Parse(tables.header.chain), travels);
  Eigen::Vector3d squareness = tables.squareness;
  std::vector<std::string> notes;
  for (int axis = 0; axis < kAxes; ++axis) {
    for (int motion = 0; motion < kMotions; ++motion) {
      const ErrorTable& table = tables.errors[static_cast<std::size_t>(kMotions * axis + motion)];
      if (table.positions.empty()) continue;
      model.SetForm(axis, motion, machine::MakeTableForm(table.positions));
      const Eigen::Map<const Eigen::VectorXd> values(
          table.values.data(), static_cast<Eigen::Index>(table.values.size()));
      model.SetCoefficients(axis, motion, values);
      // What the gauge takes off: offset + slope (x - first).
      const machine::Travel& travel = travels[static_cast<std::size_t>(axis)];
      const double kept_first = model.Function(axis, motion).Evaluate(travel.first);
      const double kept_last = model.Function(axis, motion).Evaluate(travel.last);
      const auto form = machine::MakeTableForm(table.positions);
      const double first = form->Evaluate(travel.first, table.values.data(), nullptr, nullptr);
      const double last = form->Evaluate(travel.last, table.values.data(), nullptr, nullptr);
      const double slope = (last - first - (kept_last - kept_first)) / (travel.last - travel.first);
      squareness += slope * SquarenessOfSlope(axis, motion);
      const std::string name = machine::MotionName(axis, motion);
      const char* const unit = motion < 3 ? "um" : "urad";
      if (std::abs(first) > kNothing) {
        notes.push_back(fmt::format("{} starts at {:.3g} {}; that constant is taken off", name,
                                    1e6 * first, unit));
      }
      if (std::abs(slope) > kNothing / (travel.last - travel.first)) {
        notes.push_back(fmt::format("{} has a slope of {:.3g} urad, which goes into the squareness",
                                    name, 1e6 * slope));
      }
    }
  }
  model.SetSquareness(squareness);
  MapOrigin origin;
  origin.machine = tables.header.machine;
  origin.tool = tables.header.tool;
  origin.temperature = tables.header.temperature;
  origin.scale_is_calibrated = tables.header.scale == "calibrated";
  return {ErrorMap(std::move(origin), std::move(model), {}), std::move(notes)};
}

}  // namespace abbe::map
