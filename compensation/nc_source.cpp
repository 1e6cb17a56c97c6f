#include "compensation/nc_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "compensation/nc_block.h"
#include "failure/failure.h"
#include "map/text_file.h"

namespace abbe::compensation {
namespace {

struct ControlWord {
  std::string_view word;
  NcControl control;
};

// Longer words first: "ENDWHILE" before "ENDIF" does not matter, "ELSEIF" before "ELSE" does.
constexpr std::array<ControlWord, 15> kControlWords{{{"SUB", NcControl::kSub},
                                                     {"ENDSUB", NcControl::kEndSub},
                                                     {"RETURN", NcControl::kReturn},
                                                     {"CALL", NcControl::kCall},
                                                     {"IF", NcControl::kIf},
                                                     {"ELSEIF", NcControl::kElseIf},
                                                     {"ELSE", NcControl::kElse},
                                                     {"ENDIF", NcControl::kEndIf},
                                                     {"WHILE", NcControl::kWhile},
                                                     {"ENDWHILE", NcControl::kEndWhile},
                                                     {"DO", NcControl::kDo},
                                                     {"REPEAT", NcControl::kRepeat},
                                                     {"ENDREPEAT", NcControl::kEndRepeat},
                                                     {"BREAK", NcControl::kBreak},
                                                     {"CONTINUE", NcControl::kContinue}}};

const NcParameters kNoParameters;

bool StartsWithO(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t");
  if (first == std::string_view::npos) return false;
  const char c = line[first];
  return c == 'o' || c == 'O' || c == 'n' || c == 'N' || c == '/';
}

// An O word; nothing for a line without one and for the number of a program.
std::optional<NcControlLine> ControlIn(std::string_view text, std::size_t index) {
  if (!StartsWithO(text)) return std::nullopt;
  NcCursor cursor(text, index + 1, kNoParameters);
  const bool is_deletable = cursor.Take('/');
  if (cursor.Take('N')) {
    if (!cursor.IsAtValue() || cursor.Peek() == '#' || cursor.Peek() == '[') return std::nullopt;
    cursor.Value();
  }
  if (!cursor.Take('O')) return std::nullopt;
  NcControlLine control{index, NcControl::kSub, is_deletable, {}, {}};
  const char first = cursor.Peek();
  if (first == '#' || first == '[') {
    cursor.Refuse("the name of a subroutine is computed; write the call of each out, with ifs");
  }
  if (first == '<') {
    control.name = cursor.ParameterName().name;
  } else {
    if (first < '0' || first > '9') cursor.Refuse("an O word without a name");
    control.name = fmt::format("{}", cursor.ParameterName().number);
  }
  for (const auto& [word, kind] : kControlWords) {
    NcCursor trial = cursor;
    if (!trial.TakeWord(word)) continue;
    const char next = trial.Peek();
    if (next >= 'A' && next <= 'Z') continue;
    control.control = kind;
    control.rest = trial.Rest();
    return control;
  }
  const char next = cursor.Peek();
  if (first != '<' && (next == '\0' || next == '(' || next == ';')) return std::nullopt;
  cursor.Refuse(
      fmt::format("\"{}\" after an O word; known are sub, call, return, if, while, do, "
                  "repeat, break, continue and their ends",
                  cursor.Rest().substr(0, 12)));
}

std::string_view Opener(NcControl end) {
  switch (end) {
    case NcControl::kEndSub:
      return "sub";
    case NcControl::kEndWhile:
      return "while";
    case NcControl::kEndRepeat:
      return "repeat";
    default:
      return "if";
  }
}

// Joins the lines of structures: `open` holds those that have not ended.
class Structure {
 public:
  explicit Structure(NcFile& file) : file_(file) {}

  void Take(NcControlLine line) {
    const int index = static_cast<int>(file_.controls.size());
    Join(line, index);
    file_.controls.push_back(std::move(line));
  }

  void Finish() const {
    if (open_.empty()) return;
    const NcControlLine& first = file_.controls[open_.back()];
    RefuseLine(first.line + 1, fmt::format("O{} has no end", first.name));
  }

 private:
  NcControlLine& At(int index) { return file_.controls[index]; }

  bool TopIs(NcControl control, const std::string& name) {
    return !open_.empty() && At(open_.back()).control == control && At(open_.back()).name == name;
  }

  void Close(NcControlLine& line, int index, NcControl opener) {
    if (!TopIs(opener, line.name)) {
      RefuseLine(line.line + 1, fmt::format("O{} ends a {} that does not stand right before it",
                                            line.name, Opener(line.control)));
    }
    line.next = open_.back();
    At(open_.back()).end = At(open_.back()).next = index;
    open_.pop_back();
  }

  // A branch of an if replaces the branch before it as the open one.
  void Branch(NcControlLine& line, int index, bool is_last) {
    const bool is_of_if = TopIs(NcControl::kIf, line.name) ||
                          TopIs(NcControl::kElseIf, line.name) ||
                          (is_last && TopIs(NcControl::kElse, line.name));
    if (!is_of_if) {
      RefuseLine(line.line + 1, fmt::format("O{} belongs to no if", line.name));
    }
    line.end = open_.back();  // for now the branch before it
    At(open_.back()).next = index;
    if (!is_last) {
      open_.back() = index;
      return;
    }
    for (int branch = open_.back(); branch != kNone;) {
      const int before = At(branch).control == NcControl::kIf ? kNone : At(branch).end;
      At(branch).end = index;
      branch = before;
    }
    open_.pop_back();
  }

  void Join(NcControlLine& line, int index) {
    switch (line.control) {
      case NcControl::kSub:
        for (const int open : open_) {
          if (At(open).control == NcControl::kSub) {
            RefuseLine(line.line + 1, "a subroutine within a subroutine");
          }
        }
        file_.subs.try_emplace(line.name, index);
        open_.push_back(index);
        return;
      case NcControl::kIf:
      case NcControl::kDo:
      case NcControl::kRepeat:
        open_.push_back(index);
        return;
      case NcControl::kElseIf:
      case NcControl::kElse:
        return Branch(line, index, false);
      case NcControl::kEndIf:
        return Branch(line, index, true);
      case NcControl::kEndSub:
        return Close(line, index, NcControl::kSub);
      case NcControl::kEndWhile:
        return Close(line, index, NcControl::kWhile);
      case NcControl::kEndRepeat:
        return Close(line, index, NcControl::kRepeat);
      case NcControl::kWhile:
        if (!TopIs(NcControl::kDo, line.name)) {
          open_.push_back(index);
          return;
        }
        line.control = NcControl::kWhileOfDo;
        return Close(line, index, NcControl::kDo);
      case NcControl::kBreak:
      case NcControl::kContinue:
        for (const int open : open_) {
          if (At(open).name == line.name && At(open).control != NcControl::kSub) line.next = open;
        }
        if (line.next == kNone || At(line.next).control == NcControl::kIf ||
            At(line.next).control == NcControl::kElseIf ||
            At(line.next).control == NcControl::kElse) {
          RefuseLine(line.line + 1, fmt::format("O{} belongs to no loop", line.name));
        }
        return;
      default:
        return;
    }
  }

  NcFile& file_;
  std::vector<int> open_;
};

}  // namespace

std::string_view NcFile::Line(std::size_t index) const {
  const std::size_t begin = starts[index];
  std::size_t end = index + 1 < starts.size() ? starts[index + 1] : text.size();
  while (end > begin && (text[end - 1] == '\n' || text[end - 1] == '\r')) --end;
  return std::string_view(text).substr(begin, end - begin);
}

int NcFile::ControlOf(std::size_t line) const {
  const auto found = std::lower_bound(
      controls.begin(), controls.end(), line,
      [](const NcControlLine& control, std::size_t wanted) { return control.line < wanted; });
  if (found == controls.end() || found->line != line) return kNone;
  return static_cast<int>(found - controls.begin());
}

std::unique_ptr<NcFile> ReadNcFile(std::string name, std::string text) {
  auto file = std::make_unique<NcFile>();
  file->name = std::move(name);
  file->text = std::move(text);
  if (file->text.size() > kLargestProgram) {
    throw InputError(fmt::format("{}: of {} bytes; at most {} are read: split the program",
                                 file->name, file->text.size(), kLargestProgram));
  }
  for (std::size_t at = 0; at < file->text.size();) {
    file->starts.push_back(static_cast<std::uint32_t>(at));
    const std::size_t end = file->text.find('\n', at);
    if (end == std::string::npos) break;
    at = end + 1;
  }
  Structure structure(*file);
  for (std::size_t i = 0; i < file->starts.size(); ++i) {
    if (auto control = ControlIn(file->Line(i), i)) structure.Take(std::move(*control));
  }
  structure.Finish();
  return file;
}

NcSource::NcSource(std::string name, std::string text) {
  files_.push_back(ReadNcFile(std::move(name), std::move(text)));
}

std::optional<NcSource::Place> NcSource::Find(const std::string& name, const NcFile& from) {
  const auto in = [&](const NcFile& file) -> std::optional<Place> {
    const auto found = file.subs.find(name);
    if (found == file.subs.end()) return std::nullopt;
    return Place{&file, found->second};
  };
  if (const auto place = in(from)) return place;
  for (const auto& file : files_) {
    if (const auto place = in(*file)) return place;
  }
  if (name.find('/') != std::string::npos) return std::nullopt;
  for (const std::filesystem::path& folder : folders_) {
    const std::filesystem::path path = folder / (name + ".ngc");
    if (!std::filesystem::is_regular_file(path)) continue;
    try {
      files_.push_back(ReadNcFile(path.string(), map::ReadWhole(path)));
    } catch (const InputError& failure) {
      const std::string what = failure.what();
      throw InputError(what.starts_with("line ") ? path.string() + ": " + what : what);
    }
    if (const auto place = in(*files_.back())) return place;
  }
  return std::nullopt;
}

}  // namespace abbe::compensation
