// The lines of an NC program and of its subroutines, with the structure of their O words.
//
//   NcSource source("part.ngc", text);
//   source.SearchIn("subroutines");
//   source.Find("pocket", source.main());      // its file and line, read when it is first called
//
// O words: sub endsub return call, if elseif else endif, while endwhile, do while, repeat
// endrepeat, break continue. A name is a number or <text>. A line "O100" without such a word is the
// number of the program.
// Failure: InputError with the line for a structure that is not closed, and for a file of more than
// kLargestProgram bytes. Memory: at most 16 times the size of the files, of usual ones twice.
// Source: LinuxCNC 2.9, O codes. Validity: M98 and M99 are not subroutines here.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::compensation {

inline constexpr std::size_t kLargestProgram = 2'000'000'000;  // bytes
inline constexpr int kNone = -1;

enum class NcControl {
  kSub,
  kEndSub,
  kReturn,
  kCall,
  kIf,
  kElseIf,
  kElse,
  kEndIf,
  kWhile,
  kEndWhile,
  kDo,
  kWhileOfDo,
  kRepeat,
  kEndRepeat,
  kBreak,
  kContinue
};

struct NcControlLine {
  std::size_t line;  // index
  NcControl control;
  bool is_deletable;  // behind /
  std::string name;
  std::string_view rest;  // behind the word: conditions, arguments
  // Indices into NcFile::controls: the next branch of an if, the other end of a loop, the loop of
  // break and continue; the end of the structure.
  int next = kNone, end = kNone;
};

struct NcFile {
  std::string name, text;
  std::vector<std::uint32_t> starts;  // of the lines
  std::vector<NcControlLine> controls;
  std::map<std::string, int> subs;  // name -> index into controls

  // A line without its end.
  std::string_view Line(std::size_t index) const;
  // The O word of a line; nothing if it has none.
  int ControlOf(std::size_t line) const;
};

// Reads the structure of a file.
std::unique_ptr<NcFile> ReadNcFile(std::string name, std::string text);

class NcSource {
 public:
  NcSource(std::string name, std::string text);
  // One more folder of subroutine files.
  void SearchIn(std::filesystem::path folder) { folders_.push_back(std::move(folder)); }

  const NcFile& main() const { return *files_.front(); }
  struct Place {
    const NcFile* file;
    int control;
  };
  // The subroutine `name`: in `from`, in files that were read, in NAME.ngc of the folders.
  std::optional<Place> Find(const std::string& name, const NcFile& from);

 private:
  std::vector<std::unique_ptr<NcFile>> files_;
  std::vector<std::filesystem::path> folders_;
};

}  // namespace abbe::compensation
