// `paths/nominal_path.h`.
#include "paths/nominal_path.h"

#include "fuzz/target.h"

namespace abbe::fuzz::nominal_path {

void Read(Bytes bytes) {
  Require(paths::ReadNominalPath(InputFile(bytes).path()).allFinite(), "a path has numbers only");
}

}  // namespace abbe::fuzz::nominal_path
