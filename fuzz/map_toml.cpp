// `map/map_file.h`: a map that is read can be used.
#include "fuzz/target.h"
#include "map/map_file.h"

namespace abbe::fuzz::map_toml {

void Read(Bytes bytes) {
  const map::ErrorMap map = map::ReadMap(InputFile(bytes).path());
  Eigen::Vector3d middle;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto& travel = map.model().travels()[axis];
    middle[axis] = travel.first / 2 + travel.last / 2;
  }
  map.Error(middle, map.origin().tool);
  if (map.StatesUncertainty()) map.Covariance(middle, map.origin().tool);
}

}  // namespace abbe::fuzz::map_toml
