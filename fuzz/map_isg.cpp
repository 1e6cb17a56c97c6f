// The import of Isg tables (`map/export_tables.h`), up to the map.
#include "fuzz/target.h"
#include "map/export_tables.h"

namespace abbe::fuzz::map_isg {

void Read(Bytes bytes) {
  map::AxisTables tables = map::ReadIsg(InputFile(bytes).path());
  if (tables.header.chain.empty()) tables.header.chain = "[w X Y b Z t]";
  map::MapOfTables(tables);
}

}  // namespace abbe::fuzz::map_isg
