// `simulation/extended_model.h`: the causes that a diagnosis found; what is written can be read
// again.
#include "fuzz/target.h"
#include "simulation/extended_model.h"

namespace abbe::fuzz::causes {

void Read(Bytes bytes) {
  const simulation::CauseObjects machine{"demo-mill", true, 3};
  const auto model = simulation::ReadExtendedModel(InputFile(bytes).path(), machine);
  const std::string text = simulation::ExtendedModelText(model);
  const Bytes again{reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
  const auto twice = simulation::ReadExtendedModel(InputFile(again).path(), machine);
  Require(twice.causes.size() == model.causes.size(), "a model that is written holds its causes");
}

}  // namespace abbe::fuzz::causes
