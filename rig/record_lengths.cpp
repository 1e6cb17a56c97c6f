#include "rig/record_lengths.h"

#include <fmt/format.h>

#include "random/counter_random.h"
#include "rig/streams.h"
#include "settings/toml_text.h"
#include "settings/unit.h"

namespace abbe::rig {
namespace {

constexpr double kApproach = 1e-3;  // m below the first place, where the axis starts

}  // namespace

recording::Recording RecordLengths(const LinkageRig& rig, const LengthProgram& program) {
  using settings::kMicro, settings::kMicrometre, settings::kMillimetre;
  const World& world = rig.world();
  const random::CounterRandom random(world.seed(), kLengthStream + kRunStreams * program.run);
  recording::Recording lengths;
  lengths.name = fmt::format("rig length {}, seed {}", program.axis, world.seed());
  lengths.header = fmt::format(
      "kind = \"length\"\nmachine = {}\nstarted = \"{}\"\nsource = \"rig\"\n"
      "u_scale_ppm = {}\n\n[rig]\nseed = {}\nrun = {}\n",
      settings::Quoted(world.settings().name), program.started, program.u_scale / kMicro,
      world.seed(), program.run);
  const int axis = AxisNumber(program.axis);
  std::vector<std::string> names = {"time_s",      "x_mm",
                                    "y_mm",        "z_mm",
                                    "pass",        "direction",
                                    "feed_mm_min", "length_mm",
                                    "u_length_um", fmt::format("approach_{}", "xyz"[axis])};
  names.insert(names.end(), program.sensors.begin(), program.sensors.end());
  names.emplace_back("flags");
  for (const std::string& name : names) lengths.columns.push_back({name, {}});
  Climate own(world.settings(), world.seed(), program.run, program.sensors);
  Climate& climate = program.climate != nullptr ? *program.climate : own;
  HiddenRun hidden(world.hidden(), climate, {.begin = program.begin});
  const double scale = program.u_scale * random.Normal(0);
  const Eigen::Vector3d standing = Eigen::Vector3d::Zero();
  Eigen::Vector3d place = program.at;
  place[axis] = world.settings().travels[axis].first;
  hidden.Follow(0.0, place - kApproach * Eigen::Vector3d::Unit(axis), standing);
  Eigen::Vector3d first;
  const int last = program.both_ways ? 2 * program.count : program.count;
  for (int i = 0; i <= last; ++i) {
    const bool back = i > program.count;
    const int number = back ? 2 * program.count + 1 - i : i;
    if (number == program.count && back) {
      hidden.Follow(i, place + kApproach * Eigen::Vector3d::Unit(axis), standing);
    }
    place[axis] = world.settings().travels[axis].first + number * program.step;
    hidden.Follow(i, place, standing);
    const Eigen::Vector3d tool = rig.ToolAt(hidden.Place());
    if (i == 0) first = tool;
    const double noise = program.u * random.Normal(i + 1);
    const double length = i == 0 ? 0.0 : (tool - first).norm() * (1.0 + scale) + noise;
    const double direction = back ? -1.0 : 1.0;
    std::vector<double> row = {static_cast<double>(i),
                               place[0] / kMillimetre,
                               place[1] / kMillimetre,
                               place[2] / kMillimetre,
                               1.0,
                               direction,
                               0.0,
                               length / kMillimetre,
                               program.u / kMicrometre,
                               direction};
    for (const std::string& sensor : program.sensors) {
      row.push_back(climate.At(sensor, program.begin + i));
    }
    row.push_back(0.0);
    for (std::size_t column = 0; column < row.size(); ++column) {
      lengths.columns[column].values.push_back(row[column]);
    }
  }
  return lengths;
}

}  // namespace abbe::rig
