#include "rig/length_campaign.h"

#include <fmt/format.h>

#include "random/counter_random.h"
#include "rig/streams.h"

namespace abbe::rig {

recording::Recording RecordLengths(const LinkageRig& rig, const LengthProgram& program) {
  constexpr double kMillimetre = 1e-3, kMicrometre = 1e-6, kPpm = 1e-6;
  const World& world = rig.world();
  const random::CounterRandom random(world.seed(), kLengthStream + kRunStreams * program.run);
  recording::Recording lengths;
  lengths.name = fmt::format("rig length {}, seed {}", program.axis, world.seed());
  lengths.header = fmt::format(
      "kind = \"length\"\nmachine = \"{}\"\nstarted = \"1970-01-01T00:00:00Z\"\nsource = \"rig\"\n"
      "u_scale_ppm = {}\n\n[rig]\nseed = {}\nrun = {}\n",
      world.settings().name, program.u_scale / kPpm, world.seed(), program.run);
  for (const char* name : {"time_s", "x_mm", "y_mm", "z_mm", "pass", "direction", "feed_mm_min",
                           "length_mm", "u_length_um", "flags"}) {
    lengths.columns.push_back({name, {}});
  }
  const int axis = AxisNumber(program.axis);
  const double scale = program.u_scale * random.Normal(0);
  Eigen::Vector3d place = program.at;
  place[axis] = world.settings().travels[axis].first;
  const Eigen::Vector3d first = rig.ToolAt(place);
  for (int i = 0; i <= program.count; ++i) {
    place[axis] = world.settings().travels[axis].first + i * program.step;
    const double noise = program.u * random.Normal(static_cast<std::uint64_t>(i) + 1);
    const double length = i == 0 ? 0.0 : (rig.ToolAt(place) - first).norm() * (1.0 + scale) + noise;
    std::size_t column = 0;
    for (const double value : {static_cast<double>(i), place[0] / kMillimetre,
                               place[1] / kMillimetre, place[2] / kMillimetre, 1.0, 1.0, 0.0,
                               length / kMillimetre, program.u / kMicrometre, 0.0}) {
      lengths.columns[column++].values.push_back(value);
    }
  }
  return lengths;
}

}  // namespace abbe::rig
