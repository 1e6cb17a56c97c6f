#include "recording/import.h"

#include <string_view>
#include <vector>

#include "recording/hole_table.h"
#include "recording/laser_table.h"
#include "recording/target_table.h"

namespace abbe::recording {
namespace {

struct Importer {
  std::string_view extension;  // in lower case, with its point
  Recording (*read)(const std::filesystem::path& path, const ImportOptions& options);
};

const std::vector<Importer>& Importers() {
  static const std::vector<Importer> importers{
      {".dat",
       [](const std::filesystem::path& path, const ImportOptions& options) {
         return ReadTargetTable(path, options.axis.empty() ? "X" : options.axis);
       }},
      {".rtl", [](const std::filesystem::path& path,
                  const ImportOptions& options) { return ReadLaserTable(path, options.axis); }},
      {".txt",
       [](const std::filesystem::path& path, const ImportOptions& options) {
         return ReadHoleTable(path, options.u_probing_um);
       }},
  };
  return importers;
}

}  // namespace

std::optional<Recording> Import(const std::filesystem::path& path, const ImportOptions& options) {
  for (const Importer& importer : Importers()) {
    if (path.extension() == importer.extension) return importer.read(path, options);
  }
  return std::nullopt;
}

}  // namespace abbe::recording
