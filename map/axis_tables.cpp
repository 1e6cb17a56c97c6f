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

machine::Travel TravelOf(const AxisTables& tables, int axis) {
  machine::Travel travel{-std::numeric_limits<double>::infinity(),
                         std::numeric_limits<double>::infinity()};
  for (int motion = 0; motion < kMotions; ++motion) {
    const auto& positions = tables.errors[kMotions * axis + motion].positions;
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

// If all axes that carry the workpiece count as the tool goes, they become axes of the tool: with
// X_ab the pose of a carriage, (X_Y X_X)^-1 X_Z = X_X^-1 X_Y^-1 X_Z.
bool CountsAsTool(const machine::Chain& chain) {
  const std::string& work = chain.workpiece_axes();
  return !work.empty() && std::all_of(work.begin(), work.end(),
                                      [&](char axis) { return chain.CarriageSense(axis) < 0.0; });
}

// The errors of the same axis on the tool side, at position q: X_ab^-1 = {exp(E'), q l + e'}.
geometry::ErrorVector<double> OnToolSide(const machine::Chain& chain, int axis, double q,
                                         const machine::MotionErrors<double>& errors) {
  const double sense = chain.CarriageSense("XYZ"[axis]);
  const auto X = machine::CarriagePose<double>(axis, sense, q, errors).Inverse();
  geometry::ErrorVector<double> turned;
  turned << X.p - q * machine::LineOf<double>(axis, errors.squareness),
      -errors.axes[axis].tail<3>();
  return turned;
}

}  // namespace

double TableUnit(int error) { return error < kErrors - 3 && error % kMotions < 3 ? 1e-3 : 1.0; }

AxisTables Tabulate(const ErrorMap& map, const Eigen::Vector3d& p_TQ,
                    const std::array<Eigen::Index, 3>& counts) {
  AxisTables tables;
  tables.header = HeaderOf(map, p_TQ);
  const machine::VolumetricModel& model = map.model();
  tables.squareness = model.squareness();
  const bool as_tool = CountsAsTool(model.chain());
  if (as_tool) {
    const machine::Chain all_tool = machine::Chain::Parse("[wb" + model.chain().workpiece_axes() +
                                                          model.chain().tool_axes() + "t]");
    tables.header.chain = all_tool.Text();
    tables.header.positive = all_tool.PositiveText();
  }
  for (int axis = 0; axis < kAxes; ++axis) {
    const machine::Travel& travel = model.travels()[axis];
    const auto count = counts[axis];
    if (count < 2)
      throw InputError(fmt::format("{} points along an axis: give two or more", count));
    for (Eigen::Index i = 0; i < count; ++i) {
      const double along = i / static_cast<double>(count - 1);
      const double q =
          i == count - 1 ? travel.last : travel.first + along * (travel.last - travel.first);
      machine::MotionErrors<double> errors;
      errors.squareness = model.squareness();
      auto& own = errors.axes[axis];
      for (int motion = 0; motion < kMotions; ++motion) {
        own[motion] = model.Function(axis, motion).Evaluate(q);
      }
      if (as_tool && model.chain().CarriesTarget("XYZ"[axis])) {
        own = OnToolSide(model.chain(), axis, q, errors);
      }
      for (int motion = 0; motion < kMotions; ++motion) {
        ErrorTable& table = tables.errors[kMotions * axis + motion];
        table.positions.push_back(q);
        table.values.push_back(own[motion]);
      }
    }
  }
  return tables;
}

std::vector<std::string> SignOfTables(const AxisTables& tables) {
  const machine::Chain chain = ChainOf(tables.header);
  std::vector<std::string> lines = {
      "actual - nominal of the carriage of each axis, positions and EXX, EYY, EZZ as the control "
      "counts; turns right-handed, about the carriage's reference point",
      "C0Y turns the line of Y about +z, A0Z and B0Z that of Z about +x and +y"};
  if (chain.workpiece_axes().empty()) {
    lines.emplace_back(
        "all axes on the side of the tool (ISG: workpiece_axes 0): where an error is +, the tool "
        "is displaced towards + in the workpiece");
  }
  for (const char axis : chain.workpiece_axes()) {
    lines.push_back(
        chain.CarriageSense(axis) > 0.0
            ? fmt::format(
                  "{} carries the workpiece and counts as its carriage goes: where an error "
                  "of {} is +, the tool is displaced towards - in the workpiece",
                  axis, axis)
            : fmt::format("{} carries the workpiece and counts as the tool goes: where E{}{} is +, "
                          "the tool is displaced towards + in the workpiece, where another error "
                          "of {} is +, towards -",
                          axis, axis, axis, axis));
  }
  return lines;
}

ErrorMap MapOfTables(const AxisTables& tables) {
  std::array<machine::Travel, kAxes> travels;
  const machine::Chain chain = ChainOf(tables.header);
  for (int axis = 0; axis < kAxes; ++axis) travels[axis] = TravelOf(tables, axis);
  machine::VolumetricModel model(chain, travels);
  for (int axis = 0; axis < kAxes; ++axis) {
    for (int motion = 0; motion < kMotions; ++motion) {
      const ErrorTable& table = tables.errors[kMotions * axis + motion];
      if (table.positions.empty()) continue;
      model.SetForm(axis, motion, machine::MakeTableForm(table.positions), machine::Gauge::kNone);
      model.SetCoefficients(
          axis, motion,
          Eigen::Map<const Eigen::VectorXd>(table.values.data(), table.values.size()));
    }
  }
  model.SetSquareness(tables.squareness);
  MapOrigin origin;
  origin.machine = tables.header.machine;
  origin.tool = tables.header.tool;
  origin.temperature = tables.header.temperature;
  origin.scale_is_calibrated = tables.header.scale == "calibrated";
  return {std::move(origin), std::move(model), {}};
}

}  // namespace abbe::map
