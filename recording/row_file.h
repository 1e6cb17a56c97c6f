// One form of a recording that grows row by row.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace abbe::recording {

class RowFile {
 public:
  virtual ~RowFile() = default;
  // Puts whole rows (row after row, one value per column) at the end. When it returns the kernel
  // has them: they outlive this program. DeviceError when the disk takes no more: the rows of
  // earlier calls stay readable.
  virtual void Write(std::span<const double> rows) = 0;
  // Returns when what Write() took is on the disk: it outlives the power. Another thread may
  // Write() meanwhile. DeviceError when the disk does not confirm.
  virtual void Sync() = 0;
  virtual void Close() = 0;
};

// Creates a file that holds the header and no row. InputError when it exists or cannot be created.
std::unique_ptr<RowFile> CreateCsv(const std::filesystem::path& path, const std::string& header,
                                   const std::vector<std::string>& columns);
std::unique_ptr<RowFile> CreateHdf5(const std::filesystem::path& path, const std::string& header,
                                    const std::vector<std::string>& columns);

}  // namespace abbe::recording
