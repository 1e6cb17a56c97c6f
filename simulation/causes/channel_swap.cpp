// Channels swapped: two probes are read under each other's name. The coefficient is 1.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

namespace {

std::vector<Object> PairsOfProbes(const Scene& scene) {
  std::vector<Object> pairs;
  const std::vector<Object> probes = ProbesOf(scene);
  for (std::size_t i = 0; i < probes.size(); ++i) {
    for (std::size_t j = i + 1; j < probes.size(); ++j)
      pairs.emplace_back(probes[i].name() + "+" + probes[j].name());
  }
  return pairs;
}

}  // namespace

Cause ChannelSwap() {
  return {
      .id = "channel-swap",
      .words = {.what = "the cables of two probes are exchanged",
                .shows = "two channels fit the simulation only with their names exchanged",
                .check = "the labels of the cables at the amplifier",
                .remedy = "swap the cables back, or the names in the machine file"},
      .keys = {},
      .plausible = Eigen::VectorXd::Constant(1, 1.0),
      .objects = PairsOfProbes,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        if (!trace.head) return {};
        const int one = object.first(), other = object.second();
        const Eigen::RowVectorXd apart = trace.head->gap.row(one) - trace.head->gap.row(other);
        Disturbance swapped = NoDisturbance(trace);
        swapped.row(kReadingStage + one) = apart;
        swapped.row(kReadingStage + other) = -apart;
        return {swapped};
      },
      .tell = [](const Eigen::VectorXd&, const Eigen::VectorXd&) -> Eigen::VectorXd { return {}; },
      .amount = Amount::kBinary,
      .exchanges_channels = true,
  };
}

}  // namespace abbe::simulation
