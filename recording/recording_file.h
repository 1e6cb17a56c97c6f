// Recordings as files: reading, writing, and writing as they grow.
//
// The form is chosen by the extension: .csv, or .h5 / .hdf5. A file is refused (InputError with
// file and line or row) when a column that its kind requires is missing, a row is ragged, time goes
// back, or a NaN stands in a row without a flag; a file whose end is missing, because its recorder
// was killed, opens with a warning. docs/recordings.md has every rule.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "recording/blocks.h"
#include "recording/recording.h"

namespace abbe::recording {

// The whole recording. Its `warnings` are for the person who asked for it.
Recording Read(const std::filesystem::path& path);

// The same block by block (recording/blocks.h), each of `rows` rows but the last: `use` has been
// called already when a later row is refused.
inline constexpr std::size_t kBlockRows = 16384;
void ReadBlocks(const std::filesystem::path& path, const UseBlock& use,
                std::size_t rows = kBlockRows);

// Name, header and columns, without a row.
Recording ReadHead(const std::filesystem::path& path);

// Writes the whole recording; the file appears under its name only when it is complete, and another
// recording is not overwritten unless the user says so (recording/whole_file.h). InputError for a
// recording that Read() would refuse, DeviceError when the disk is full.
void Write(const Recording& recording, const std::filesystem::path& path);

// Appends rows to a file while they are measured. Within a second a row is with the kernel and
// outlives this program, however slow the disk; when Flush() or Close() returns it is on the disk.
// Memory does not grow with the length. One thread appends; threads of the writer's own wait.
class Writer {
 public:
  virtual ~Writer() = default;

  // Creates the file. InputError when it exists already (nothing measured is ever overwritten),
  // when the folder cannot be written, or for a header or names that Read() would refuse.
  static std::unique_ptr<Writer> Create(const std::filesystem::path& path,
                                        const std::string& header,
                                        const std::vector<std::string>& columns);

  // `row` has one value per column. DeviceError ("disk full ...") when the disk takes no more, from
  // then on each time; rows written before stay readable.
  virtual void Append(std::span<const double> row) = 0;
  virtual void Flush() = 0;
  // Flushes and closes; the destructor does the same and swallows errors.
  virtual void Close() = 0;
};

}  // namespace abbe::recording
