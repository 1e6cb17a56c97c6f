// Where tests find files.
#pragma once

#include <filesystem>

namespace abbe {

std::filesystem::path SourceFolder();
std::filesystem::path BuildFolder();
std::filesystem::path DemoMillFile();  // its machine file
std::filesystem::path
FieldData();  // ABBE_FIELD_DATA; else where the sources have it, perhaps absent

}  // namespace abbe
