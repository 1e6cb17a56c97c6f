#include "machine/machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "failure/failure.h"
#include "machine/configurations.h"

namespace abbe::machine {
namespace {

Chain ReadChain(const settings::Table& root) {
  const std::string text = root.Text("chain");
  try {
    return ChainOf(text);
  } catch (const InputError& error) {
    throw root.Error("chain", error.what());
  }
}

Travel ReadTravel(const settings::Table& axis) {
  const std::vector<double> ends = axis.Quantities("travel_mm", 2);
  axis.RefuseUnknown();
  if (!(ends[0] < ends[1])) {
    throw axis.Error("travel_mm", "must be [first, last] with the first below the last");
  }
  return {ends[0], ends[1]};
}

Population ReadPopulation(const settings::Table& table) {
  const auto tolerance = [&](std::string_view key, double fallback) {
    return table.Quantity(key, {.fallback = fallback, .at_least = 0.0});
  };
  const Population population{
      .positioning = tolerance("positioning_um", 2.0),
      .straightness = tolerance("straightness_um", 1.0),
      .roll = tolerance("roll_urad", 20.0),
      .pitch = tolerance("pitch_urad", 20.0),
      .yaw = tolerance("yaw_urad", 20.0),
      .squareness = tolerance("squareness_urad", 30.0),
      .scale = tolerance("scale_ppm", 20.0),
      .smoothness = table.Quantity("smoothness_mm", {.fallback = 15.0, .above = 0.0}),
  };
  table.RefuseUnknown();
  return population;
}

}  // namespace

int AxisIndex(char axis) {
  if (axis < 'X' || axis > 'Z') {
    throw InputError(fmt::format("'{}' is no linear axis; name X, Y or Z", axis));
  }
  return axis - 'X';
}

double InTravel(const Travel& travel, int axis, double position) {
  const double rounding = 16 * std::numeric_limits<double>::epsilon() *
                          std::max(std::abs(travel.first), std::abs(travel.last));
  if (!(position >= travel.first - rounding && position <= travel.last + rounding)) {
    if (!(travel.last > travel.first)) {
      throw InputError(
          fmt::format("{} = {:.9g} mm, but the machine has no axis {}: add it to the "
                      "chain and as [axis.{}], or leave the position out",
                      "XYZ"[axis], 1e3 * position, "XYZ"[axis], "XYZ"[axis]));
    }
    throw InputError(
        fmt::format("{} = {:.9g} mm lies outside its travel, {:.9g} to {:.9g} mm: the errors of "
                    "the machine are "
                    "not known there",
                    "XYZ"[axis], 1e3 * position, 1e3 * travel.first, 1e3 * travel.last));
  }
  return std::clamp(position, travel.first, travel.last);
}

Machine ReadMachine(const settings::Table& root) {
  const std::vector<double> reference =
      root.Quantities("reference_mm", 3, std::vector<double>{0.0, 0.0, 0.0});
  const settings::Table axes = root.Child("axis");
  Machine machine{
      .name = root.Text("name"),
      .chain = ReadChain(root),
      .reference = Eigen::Vector3d(reference[0], reference[1], reference[2]),
      .travels = {},
      .population = ReadPopulation(root.Child("population")),
  };
  for (std::size_t i = 0; i < machine.travels.size(); ++i) {
    const char letter = "XYZ"[i];
    const std::string name(1, letter);
    if (machine.chain.Text().find(letter) != std::string::npos) {
      machine.travels[i] = ReadTravel(axes.Child(name));
    } else if (axes.Has(name)) {
      throw axes.Error(name, fmt::format("is no axis of the chain {}; add it there, or remove the "
                                         "table",
                                         machine.chain.Text()));
    }
  }
  axes.RefuseUnknown();
  return machine;
}

Machine ReadMachineWithoutAxes(const settings::Table& root) {
  return {.name = root.Text("name"),
          .chain = Chain::Parse("[w b X Y Z t]"),
          .reference = Eigen::Vector3d::Zero(),
          .travels = {},
          .population = ReadPopulation(root.Child("population"))};
}

}  // namespace abbe::machine
