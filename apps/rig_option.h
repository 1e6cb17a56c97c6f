// A world of the virtual rig as one text: "seed=7,hide=backlash:object=X:width_um=6".
//
// `hide` may be repeated. Failure: InputError for another key.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace abbe::apps {

struct RigOption {
  std::uint64_t seed = 1;
  std::vector<std::string> hide = {};
};
RigOption ParseRigOption(const std::string& text);

}  // namespace abbe::apps
