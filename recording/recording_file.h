// Recordings as files: reading, writing, and writing as they grow.
//
// The form is chosen by the extension: .csv, or .h5 / .hdf5. A file is refused (InputError with
// file and line or row) when a column that its kind requires is missing, a row is ragged, time does
// not increase, or a NaN stands in a row without a flag; a truncated file opens with a warning.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "recording/recording.h"

namespace abbe::recording {

Recording Read(const std::filesystem::path& path);

// Writes the whole recording; the file appears under its name only when it is complete.
void Write(const Recording& recording, const std::filesystem::path& path);

// Appends rows to a file while they are measured. At the latest every second, and whenever Flush()
// is called, everything appended so far is on disk. Memory does not grow with the length.
class Writer {
 public:
  virtual ~Writer() = default;

  // Creates the file. InputError when it exists already (nothing measured is ever overwritten) or
  // when the folder cannot be written.
  static std::unique_ptr<Writer> Create(const std::filesystem::path& path,
                                        const std::string& header,
                                        const std::vector<std::string>& columns);

  // `row` has one value per column. DeviceError ("disk full ...") when the disk takes no more; rows
  // written before stay readable.
  virtual void Append(std::span<const double> row) = 0;
  virtual void Flush() = 0;
  // Flushes and closes; the destructor does the same and swallows errors.
  virtual void Close() = 0;
};

}  // namespace abbe::recording
