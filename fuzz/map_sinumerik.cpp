// Compensation tables of Sinumerik (`map/export_axis_comp.h`).
#include "fuzz/target.h"
#include "machine/chain.h"
#include "map/export_axis_comp.h"

namespace abbe::fuzz::map_sinumerik {

void Read(Bytes bytes) {
  const InputFile file(bytes);
  const auto field = map::ReadBackSinumerik({file.path()}, machine::Chain::Parse("[w X Y b Z t]"));
  field({0.01, 0.02, 0.03});
}

}  // namespace abbe::fuzz::map_sinumerik
