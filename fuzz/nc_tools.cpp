// A control's tool table, `compensation/nc_tables.h`: numbers of tools are what they say.
#include <cmath>

#include "compensation/nc_tables.h"
#include "fuzz/target.h"

namespace abbe::fuzz::nc_tools {

void Read(Bytes bytes) {
  const InputFile file(bytes);
  for (const auto& [number, tool] : compensation::ReadTools(file.path())) {
    Require(number >= 0 && tool.offset.allFinite() && std::isfinite(tool.diameter) &&
                tool.orientation >= 0 && tool.orientation <= 9,
            "a tool has numbers");
  }
}

}  // namespace abbe::fuzz::nc_tools
