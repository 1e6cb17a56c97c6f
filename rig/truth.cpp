#include "rig/truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "failure/failure.h"

namespace abbe::rig {
namespace {

using nlohmann::ordered_json;

constexpr int kStepsWithoutPlan = 60;
constexpr std::array<const char*, kProbes> kProbeNames = {"probe_a", "probe_b", "probe_c",
                                                          "probe_d", "probe_e"};

std::string AxisName(int axis) { return {static_cast<char>('X' + axis)}; }

std::vector<double> StationsOf(const RigSettings& settings, int axis) {
  if (settings.sweeps[axis]) return settings.sweeps[axis]->stations;
  const auto [first, last] = settings.travels[axis];
  std::vector<double> stations;
  stations.reserve(kStepsWithoutPlan + 1);
  for (int i = 0; i <= kStepsWithoutPlan; ++i) {
    stations.push_back(first + (last - first) * i / kStepsWithoutPlan);
  }
  return stations;
}

ordered_json AxisTruth(const World& world, int axis) {
  const std::vector<double> stations = StationsOf(world.settings(), axis);
  ordered_json truth;
  truth["carries"] = world.settings().CarriesTarget(axis) ? "target" : "head";
  truth["stations_m"] = stations;
  for (int motion = 0; motion < kMotions; ++motion) {
    std::vector<double> values;
    values.reserve(stations.size());
    for (const double station : stations) values.push_back(world.ErrorsOf(axis, station)[motion]);
    truth[MotionName(axis, motion)] = values;
  }
  return truth;
}

std::vector<double> ListedNumbers(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

// At eleven gaps over the range.
std::vector<double> Departures(const Characteristic& characteristic) {
  std::vector<double> departures;
  for (int gap = 0; gap <= 10; ++gap) departures.push_back(characteristic.At(gap / 10.0));
  return departures;
}

ordered_json HeadTruth(const World& world) {
  ordered_json head;
  for (int probe = 0; probe < kProbes; ++probe) {
    const auto& [along, across, depth, gain, departs] = world.probes()[probe];
    head[kProbeNames[probe]] = {{"along_m", along},
                                {"across_m", across},
                                {"depth_m", depth},
                                {"gain", gain},
                                {"departures_m", Departures(departs)}};
  }
  for (int axis = 0; axis < kAxes; ++axis) {
    const HeadInstallation& installed = world.InstallationOf(axis);
    head["axis_" + AxisName(axis)] = {{"angles_rad", ListedNumbers(installed.angles)},
                                      {"offsets_m", ListedNumbers(installed.offsets)},
                                      {"set_gap_m", installed.set_gap}};
  }
  head["target"] = {{"tilt_rad", ListedNumbers(world.target().tilt)},
                    {"squareness_rad", ListedNumbers(world.target().squareness)}};
  return head;
}

// A list of numbers of a JSON object.
std::vector<double> NumbersOf(const ordered_json& object, const std::string& key,
                              const std::string& name) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array()) {
    throw InputError(
        fmt::format("{}: has no list \"{}\"; compare the JSON that `abbe sweep` or "
                    "`abbe reduce --json` wrote with the truth of `abbe rig --truth`",
                    name, key));
  }
  std::vector<double> numbers;
  for (const auto& number : *found) {
    numbers.push_back(number.is_number() ? number.get<double>()
                                         : std::numeric_limits<double>::quiet_NaN());
  }
  return numbers;
}

// The values of a function given at `stations`, at other places.
std::vector<double> Interpolated(const std::vector<double>& stations,
                                 const std::vector<double>& values,
                                 const std::vector<double>& places, const std::string& name) {
  const double slack = 0.01 * (stations.back() - stations.front()) / (stations.size() - 1);
  std::vector<double> found;
  for (const double place : places) {
    if (!(place > stations.front() - slack && place < stations.back() + slack)) {
      throw InputError(fmt::format(
          "{}: the station {:.6g} m lies outside those of the truth, {:.6g} to {:.6g} m; compare "
          "with the truth of the same machine file",
          name, place, stations.front(), stations.back()));
    }
    const auto after = std::upper_bound(stations.begin() + 1, stations.end() - 1, place);
    const std::size_t i = after - stations.begin();
    const double share = (place - stations[i - 1]) / (stations[i] - stations[i - 1]);
    found.push_back((1.0 - share) * values[i - 1] + share * values[i]);
  }
  return found;
}

// Removes what a sweep does not define: the first value of an angle, the line of a straightness.
void Reduce(bool angle, const std::vector<double>& stations, std::vector<double>& values) {
  const double n = values.size();
  double offset = values.front(), slope = 0.0, middle = 0.0;
  if (!angle) {
    double mean = 0.0, product = 0.0, square = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      middle += stations[i] / n;
      mean += values[i] / n;
    }
    for (std::size_t i = 0; i < values.size(); ++i) {
      product += (stations[i] - middle) * (values[i] - mean);
      square += (stations[i] - middle) * (stations[i] - middle);
    }
    offset = mean;
    slope = product / square;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] -= offset + slope * (stations[i] - middle);
  }
}

ComponentComparison CompareComponent(const std::string& component,
                                     const std::vector<double>& errors,
                                     const std::vector<double>& u) {
  ComponentComparison comparison{component, errors.size(), 0.0, 0.0, 0.0, 0.0};
  double squares = 0.0, pulls = 0.0, inside = 0.0, uncertain = 0.0;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    squares += errors[i] * errors[i];
    comparison.max_error = std::max(comparison.max_error, std::abs(errors[i]));
    if (u[i] == 0.0 && errors[i] == 0.0) continue;
    const double pull = u[i] > 0.0 ? errors[i] / u[i] : std::numeric_limits<double>::quiet_NaN();
    pulls += pull * pull;
    inside += std::abs(pull) <= 2.0 ? 1.0 : 0.0;
    uncertain += 1.0;
  }
  comparison.rms_error = std::sqrt(squares / errors.size());
  comparison.rms_pull = std::sqrt(pulls / uncertain);
  comparison.share_inside_2u =
      std::isnan(pulls) ? std::numeric_limits<double>::quiet_NaN() : inside / uncertain;
  return comparison;
}

}  // namespace

ordered_json TruthOf(const World& world) {
  ordered_json truth;
  truth["machine"] = world.settings().name;
  truth["seed"] = world.seed();
  for (int axis = 0; axis < kAxes; ++axis) {
    if (!(world.settings().travels[axis].last > world.settings().travels[axis].first)) continue;
    truth["axes"][AxisName(axis)] = AxisTruth(world, axis);
    truth["scale"][AxisName(axis)] = world.ScaleOf(axis);
  }
  const auto& [a0z, b0z, c0y] = world.squareness();
  truth["squareness"] = {{"A0Z", a0z}, {"B0Z", b0z}, {"C0Y", c0y}};
  truth["head"] = HeadTruth(world);
  truth["hidden"] = TruthOf(world.hidden());
  return truth;
}

std::vector<ComponentComparison> Compare(const ordered_json& truth, const ordered_json& result,
                                         const std::string& name) {
  const std::string axis = result.value("axis", "");
  if (!truth.contains("axes") || !truth["axes"].contains(axis) || !result.contains("errors")) {
    throw InputError(
        fmt::format("{}: is not the result of a sweep of an axis in the truth; give the "
                    "truth first, then the JSON of sweeps",
                    name));
  }
  const ordered_json& axis_truth = truth["axes"][axis];
  const std::vector<double> true_stations = NumbersOf(axis_truth, "stations_m", "truth");
  const std::vector<double> stations = NumbersOf(result, "stations", name);
  std::vector<ComponentComparison> comparisons;
  for (const auto& [component, error] : result["errors"].items()) {
    std::vector<double> value = NumbersOf(error, "value", name);
    const std::vector<double> u = NumbersOf(error, "u", name);
    const std::vector<double> true_values = NumbersOf(axis_truth, component, "truth");
    if (value.size() != stations.size() || u.size() != stations.size() || stations.size() < 3) {
      throw InputError(
          fmt::format("{}: \"{}\" has {} values and {} uncertainties for {} stations; "
                      "reduce the recording again",
                      name, component, value.size(), u.size(), stations.size()));
    }
    std::vector<double> expected = Interpolated(true_stations, true_values, stations, name);
    const bool angle = component.size() == 3 && component[1] >= 'A' && component[1] <= 'C';
    Reduce(angle, stations, value);
    Reduce(angle, stations, expected);
    for (std::size_t i = 0; i < value.size(); ++i) value[i] -= expected[i];
    comparisons.push_back(CompareComponent(component, value, u));
  }
  return comparisons;
}

}  // namespace abbe::rig
