// Reading an HDF5 file in a child process.
//
// libhdf5 trusts what a file says of itself: a damaged one makes it crash, run without end or take
// all memory. So a child opens the file and hands over what it reads, and this process never does.
// The child is limited in time (3 s of CPU, and 1 s for each 2 MB of the file; without a word for 20
// times as long by the clock) and in memory.
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

// Most bytes of numbers that a file of so many bytes may hold: deflate packs noise by 1 to 2 and
// constants by up to 1000, a recording as a whole by 7 to 100.
std::uint64_t MostHdf5Numbers(const std::filesystem::path& path);

// Most bytes of a text.
inline constexpr std::size_t kMostHdf5Text = std::size_t{1} << 20;

// What the child sends: messages of a kind (a letter, no 'e', no 'd') with their bytes.
class Hdf5Sender {
 public:
  explicit Hdf5Sender(int pipe) : pipe_(pipe) {}
  void Send(char kind, std::string_view bytes) const;
  // In messages of at most 1 MiB each.
  void Send(char kind, std::span<const double> values) const;

 private:
  int pipe_;
};

// Calls `read` in a child, and `take` here for each of its messages in their order until it returns
// false. InputError as `read` threw it, and one that says so when the child crashed, or took more
// time or memory than it may.
void ReadInChild(const std::filesystem::path& path,
                 const std::function<void(const Hdf5Sender& sender)>& read,
                 const std::function<bool(char kind, std::string_view bytes)>& take);

// A text attribute, of fixed length as ours or of variable length as others write it. InputError
// when there is none, or when it is anything but one text.
std::string TextAttribute(hid_t object, const char* attribute, const std::string& file);

// A data set of plain numbers that the file itself holds: no link, nothing in other files, no
// foreign filter, and storage for all of them. To be opened and read in a child only.
class Hdf5Numbers {
 public:
  // `rank` dimensions; InputError naming the file and the data set for anything else.
  Hdf5Numbers(hid_t file, const std::string& name, int rank, const std::string& file_name);

  hid_t id() const { return set_.id(); }
  hsize_t count() const { return count_; }
  const std::string& name() const { return name_; }
  // InputError unless each number was written. Not for a file that still grows.
  void RequireStorage(const std::string& file_name) const;

 private:
  std::string name_;
  Handle set_;
  hsize_t count_ = 0;
};

}  // namespace abbe::recording
