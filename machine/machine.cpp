#include "machine/machine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "failure/failure.h"
#include "machine/configurations.h"
#include "machine/drift.h"

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
  if (!(ends[0] < ends[1])) {
    throw axis.Error("travel_mm", "must be [first, last] with the first below the last");
  }
  return {ends[0], ends[1]};
}

Travel ReadLimit(const settings::Table& axis, const Travel& travel) {
  if (!axis.Has("limit_mm")) {
    axis.Quantities("limit_mm", 0, std::vector<double>{});  // requested, without a fallback value
    return {travel.first - kBeyondTravel, travel.last + kBeyondTravel};
  }
  const std::vector<double> ends = axis.Quantities("limit_mm", 2);
  if (ends[0] > travel.first || ends[1] < travel.last) {
    throw axis.Error("limit_mm", "must be [first, last], the soft limits, and contain travel_mm");
  }
  return {ends[0], ends[1]};
}

// An axis that carries the tool may have the key too: both words then mean the same.
Positive ReadPositive(const settings::Table& axis, char letter, const Chain& chain) {
  if (!axis.Has("positive") && chain.CarriesTarget(letter)) {
    throw axis.Error(
        "positive",
        fmt::format("is missing: {} carries the workpiece; write positive = \"tool\" where its "
                    "number rises as the tool goes towards + against the workpiece (ISO 841, the "
                    "table then goes towards -), or positive = \"carriage\" where it rises as the "
                    "table itself goes towards +",
                    letter));
  }
  const std::string word = axis.Text("positive", "tool");
  const std::optional<Positive> positive = PositiveNamed(word);
  if (positive) return *positive;
  throw axis.Error("positive", fmt::format("\"{}\" is not one of: tool, carriage", word));
}

Population ReadPopulation(const settings::Table& table) {
  Population population = ReadSizes(table, {.positioning = 2.0,
                                            .straightness = 1.0,
                                            .roll = 20.0,
                                            .pitch = 20.0,
                                            .yaw = 20.0,
                                            .squareness = 30.0,
                                            .scale = 20.0,
                                            .smoothness = 0.0});
  population.smoothness = table.Quantity("smoothness_mm", {.fallback = 15.0, .above = 0.0});
  table.RefuseUnknown();
  return population;
}

}  // namespace

int AxisIndex(char axis) {
  if (axis < 'X' || axis > 'Z') {
    throw InputError(fmt::format("'{}' is not a linear axis; name X, Y or Z", axis));
  }
  return axis - 'X';
}

double PopulationDeviation(const Population& population, int axis, int motion) {
  if (motion < 3) return motion == axis ? population.positioning : population.straightness;
  const int about = motion - 3;
  if (about == axis) return population.roll;
  return about == (axis == 1 ? 0 : 1) ? population.pitch : population.yaw;
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
                    "the machine are not known there",
                    "XYZ"[axis], 1e3 * position, 1e3 * travel.first, 1e3 * travel.last));
  }
  return std::clamp(position, travel.first, travel.last);
}

std::array<Travel, 3> AroundTravels(const std::array<Travel, 3>& travels) {
  std::array<Travel, 3> around = travels;
  for (Travel& each : around) each = {each.first - kBeyondTravel, each.last + kBeyondTravel};
  return around;
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
      .limits = {},
      .population = ReadPopulation(root.Child("population")),
  };
  std::array<Positive, 3> positive{};
  for (std::size_t i = 0; i < machine.travels.size(); ++i) {
    const char letter = "XYZ"[i];
    const std::string name(1, letter);
    if (machine.chain.Text().find(letter) == std::string::npos) {
      if (axes.Has(name)) {
        throw axes.Error(name,
                         fmt::format("is not an axis of the chain {}; add it there, or remove "
                                     "the table",
                                     machine.chain.Text()));
      }
      continue;
    }
    const settings::Table axis = axes.Child(name);
    machine.travels[i] = ReadTravel(axis);
    machine.limits[i] = ReadLimit(axis, machine.travels[i]);
    positive[i] = ReadPositive(axis, letter, machine.chain);
    axis.RefuseUnknown();
  }
  machine.chain.SetPositive(positive);
  axes.RefuseUnknown();
  return machine;
}

Machine ReadMachineWithoutAxes(const settings::Table& root) {
  return {.name = root.Text("name"),
          .chain = Chain::Parse("[w b X Y Z t]"),
          .reference = Eigen::Vector3d::Zero(),
          .travels = {},
          .limits = {},
          .population = ReadPopulation(root.Child("population"))};
}

}  // namespace abbe::machine
