// Recordings as files: reading, writing, and appending rows.
//
// The form is chosen by the extension: .csv, or .h5 / .hdf5. A file is refused (InputError with
// file and line or row) when a required column is missing, a row has a wrong number of fields, time
// decreases, or a row without a flag contains a NaN. A file without its end, because its recorder
// was killed, is read with a warning. docs/recordings.md has every rule.
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

// Reads the whole recording. Its `warnings` are for the user.
Recording Read(const std::filesystem::path& path);

// Reads block by block (recording/blocks.h), `rows` rows each except the last. `use` has been
// called for the earlier blocks when a later row is refused.
inline constexpr std::size_t kBlockRows = 16384;
void ReadBlocks(const std::filesystem::path& path, const UseBlock& use,
                std::size_t rows = kBlockRows);

// Reads name, header and columns, without a row.
Recording ReadHead(const std::filesystem::path& path);

// Writes the whole recording; the file appears under its name only when it is complete, and another
// recording is not overwritten unless the user says so (recording/whole_file.h). InputError for a
// recording that Read() would refuse, DeviceError when the disk is full.
void Write(const Recording& recording, const std::filesystem::path& path);

// Appends rows to a file while they are measured. Within a second a row is in the
// kernel and survives a crash of this program, however slow the disk; when Flush()
// or Close() returns it is on the disk.
// Memory does not grow with the length. Threads: one thread appends; the
// writer has threads of its own for the disk.
class Writer {
 public:
  virtual ~Writer() = default;

  // Creates the file. InputError when it exists already (nothing measured is ever overwritten),
  // when the folder cannot be written, or for a header or names that Read() would refuse.
  static std::unique_ptr<Writer> Create(const std::filesystem::path& path,
                                        const std::string& header,
                                        const std::vector<std::string>& columns);

  // `row` has one value per column. DeviceError ("disk full ...") when the disk is full, and from
  // then on each time; earlier rows stay readable.
  virtual void Append(std::span<const double> row) = 0;
  virtual void Flush() = 0;
  // Flushes and closes; the destructor does the same and ignores errors.
  virtual void Close() = 0;
};

}  // namespace abbe::recording
