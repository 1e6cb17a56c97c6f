// The numbers of a control's INI file, `compensation/nc_tables.h`.
#include "compensation/nc_tables.h"
#include "fuzz/target.h"

namespace abbe::fuzz::nc_ini {

void Read(Bytes bytes) {
  const InputFile file(bytes);
  for (const auto& [key, number] : compensation::ReadIniNumbers(file.path())) {
    Require(key.find('.') != std::string::npos, "a key has its section");
  }
}

}  // namespace abbe::fuzz::nc_ini
