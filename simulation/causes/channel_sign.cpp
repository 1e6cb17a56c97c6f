// Channel sign: Delta is inverted. The coefficient is 1.
#include "simulation/causes/registry.h"

namespace abbe::simulation {

Cause ChannelSign() {
  return {
      .id = "channel-sign",
      .words = {.what = "a channel counts the wrong way",
                .shows = "a channel mirrors what it should show",
                .check = "polarity of the amplifier, sign of the scale in the machine file",
                .remedy = "correct the sign in the machine file"},
      .keys = {},
      .plausible = Eigen::VectorXd::Constant(1, 1.0),
      .objects = ProbesOf,
      .columns = [](const Trace& trace, const Object& object,
                    const Eigen::VectorXd&) -> std::vector<Disturbance> {
        if (!trace.head) return {};
        const Eigen::Index probe = trace.head->row_of[static_cast<std::size_t>(object.first())];
        return {InStage(trace, kReadingStage + probe,
                        2.0 * (trace.head->gap.row(probe).array() - trace.head->zero[probe]))};
      },
      .tell = [](const Eigen::VectorXd&, const Eigen::VectorXd&) -> Eigen::VectorXd { return {}; },
      .amount = Amount::kBinary,
  };
}

}  // namespace abbe::simulation
