// The file of a recording that is written row by row, in one of the two forms.
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
  // Appends whole rows (row after row, one value per column). When it returns the kernel has
  // them and they survive a crash of this program. DeviceError when the disk is full; the
  // rows of earlier calls stay readable.
  virtual void Write(std::span<const double> rows) = 0;
  // Returns when the rows of earlier Write() calls are on the disk and survive a power failure.
  // Another thread may call Write() meanwhile. DeviceError when the disk does not confirm.
  virtual void Sync() = 0;
  virtual void Close() = 0;
};

// Creates a file with the header and no row. InputError when it exists or cannot be created.
std::unique_ptr<RowFile> CreateCsv(const std::filesystem::path& path, const std::string& header,
                                   const std::vector<std::string>& columns);
std::unique_ptr<RowFile> CreateHdf5(const std::filesystem::path& path, const std::string& header,
                                    const std::vector<std::string>& columns);

}  // namespace abbe::recording
