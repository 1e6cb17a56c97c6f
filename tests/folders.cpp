#include "folders.h"

#include <cstdlib>

namespace abbe {

std::filesystem::path SourceFolder() { return ABBE_SOURCE_DIR; }

std::filesystem::path BuildFolder() { return ABBE_BINARY_DIR; }

std::filesystem::path DemoMillFile() { return SourceFolder() / "machines/demo_mill.toml"; }

std::filesystem::path FieldData() {
  const char* folder = std::getenv("ABBE_FIELD_DATA");
  return folder != nullptr ? folder : SourceFolder() / "../shared/data";
}

}  // namespace abbe
