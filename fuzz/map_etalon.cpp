// The import of Etalon tables (`map/export_tables.h`), up to the map.
#include "fuzz/target.h"
#include "map/export_tables.h"

namespace abbe::fuzz::map_etalon {

void Read(Bytes bytes) {
  map::AxisTables tables = map::ReadEtalon(InputFile(bytes).path());
  if (tables.header.chain.empty()) tables.header.chain = "[w X Y b Z t]";
  map::MapOfTables(tables);
}

}  // namespace abbe::fuzz::map_etalon
