// What a fuzzing target is made of: bytes in, one reader, nothing but an InputError out.
//
//   namespace abbe::fuzz::hole_table {
//   void Read(Bytes bytes) { recording::ReadHoleTable(InputFile(bytes).path(), 0.5); }
//   }
//
// A file NAME.cpp with a function NAME::Read, a line in CMakeLists.txt and a folder corpus/NAME are
// a target. It ends the program, as a crash does, for what Require() finds broken; whatever else
// may go wrong is found by who calls it (contract.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace abbe::fuzz {

using Bytes = std::span<const std::uint8_t>;

inline std::string_view TextOf(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// The bytes as a file in memory, for readers that take a path; gone with the object.
class InputFile {
 public:
  explicit InputFile(Bytes bytes);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  int file_;
  std::filesystem::path path_;
};

// A file of the project as text, for what a reader needs besides its input.
std::string ProjectText(const std::filesystem::path& name);

// Ends the program when something that must hold does not.
void Require(bool holds, const char* what);

}  // namespace abbe::fuzz
