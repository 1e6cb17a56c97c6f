// Reading an HDF5 file in a child process.
//
// libhdf5 does not validate files: a damaged one makes it crash, run for ever or take all memory.
// So only a child process opens the file and sends its content to this one.
// The child is limited in CPU time (3 s, and 1 s for each 2 MB of the file), in silence (20 times
// as long by the clock without a message) and in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "recording/hdf5_handle.h"

namespace abbe::recording {

// Upper limit of the bytes of numbers in a file of this size: deflate compresses noise by 1 to 2
// and constants by up to 1000, a whole recording by 7 to 100.
std::uint64_t MostHdf5Numbers(const std::filesystem::path& path);

// Upper limit of the bytes of a text.
inline constexpr std::size_t kMostHdf5Text = std::size_t{1} << 20;

// The messages of the child: a kind (a letter other than 'e' and 'd') and bytes.
class Hdf5Sender {
 public:
  explicit Hdf5Sender(int pipe) : pipe_(pipe) {}
  void Send(char kind, std::string_view bytes) const;
  // In messages of at most 1 MiB each.
  void Send(char kind, std::span<const double> values) const;

 private:
  int pipe_;
};

// Calls `read` in a child, and `take` in this process for each of its messages in order, until it
// returns false. Throws the InputError of `read`, and one for a damaged file when the child
// crashed or exceeded its time or memory.
void ReadInChild(const std::filesystem::path& path,
                 const std::function<void(const Hdf5Sender& sender)>& read,
                 const std::function<bool(char kind, std::string_view bytes)>& take);

// A text attribute of fixed length, as abbe writes it, or of variable length. InputError when it is
// missing or not a single text.
std::string TextAttribute(hid_t object, const char* attribute, const std::string& file);

// A data set of plain numbers stored in the file itself: no link, no external file, no foreign
// filter.
// Open and read it in a child only.
class Hdf5Numbers {
 public:
  // InputError, naming the file and the data set, unless it is such a set of `rank` dimensions.
  Hdf5Numbers(hid_t file, const std::string& name, int rank, const std::string& file_name);

  hid_t id() const { return set_.id(); }
  hsize_t count() const { return count_; }
  const std::string& name() const { return name_; }
  // InputError unless every number is stored. Not for a file that still grows.
  void RequireStorage(const std::string& file_name) const;

 private:
  std::string name_;
  Handle set_;
  hsize_t count_ = 0;
};

}  // namespace abbe::recording
