// abbe correct: correction of measured coordinates or an NC program by an error map.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cerrno>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/causes_option.h"
#include "apps/command.h"
#include "apps/commands.h"
#include "apps/map_option.h"
#include "apps/path_table.h"
#include "apps/result_file.h"
#include "compensation/corrected_table.h"
#include "compensation/nc_correction.h"
#include "failure/failure.h"
#include "map/text_file.h"
#include "recording/whole_file.h"

namespace abbe::apps {
namespace {

struct CorrectCommand {
  MapOption map;
  std::filesystem::path from, out, json;
  CausesOption causes;
  std::vector<double> work_offset_mm = {0.0, 0.0, 0.0};
  std::vector<double> start_mm, zero_mm;
  double chord_um = 1.0, feed_mm_min = 0.0;
  double length_mm = 0.0;  // 0: from the map
  bool quiet = false;
};

// Largest deviation of a line of commands from the corrected line, if its length is not given.
constexpr double kLineTolerance = 0.1e-6;
constexpr std::size_t kBuffer = 1 << 20;
constexpr std::size_t kLongestLine = 1 << 16;

std::filesystem::path OutOf(const CorrectCommand& options) {
  if (!options.out.empty()) return options.out;
  std::filesystem::path out = options.from;
  out.replace_filename(
      fmt::format("{}_corrected{}", out.stem().string(), out.extension().string()));
  return out;
}

nlohmann::ordered_json ResultOf(const CorrectCommand& options, const map::ErrorMap& map,
                                std::string_view kind, double largest) {
  return {{"abbe", ABBE_VERSION},
          {"command", "correct"},
          {"kind", kind},
          {"machine", map.origin().machine},
          {"chain", map.model().chain().Text()},
          {"map", options.map.path.filename()},
          {"scale", map.Scale()},
          {"from", options.from.filename()},
          {"out", OutOf(options).filename()},
          {"largest_um", largest * 1e6}};
}

void CorrectCsv(const CorrectCommand& options, const map::ErrorMap& map,
                const compensation::Corrector& corrector) {
  const PathCauses causes(options.causes, map.origin().machine, options.feed_mm_min);
  const auto table = compensation::CorrectTable(
      map::ReadWhole(options.from), options.from.string(), corrector,
      causes.Active() ? causes.Beside(ReadPathTable(options.from)) : Eigen::Matrix3Xd());
  WriteText(table.text, OutOf(options));
  if (!options.json.empty()) {
    auto result = ResultOf(options, map, "table", table.largest);
    result["rows"] = table.rows;
    causes.AddTo(result);
    WriteResult(result, options.json);
  }
  if (options.quiet) return;
  fmt::print("{}: {} positions, corrected by up to {:.3g} um\n", OutOf(options).string(),
             table.rows, table.largest * 1e6);
  if (causes.Active()) fmt::print("{}\n", causes.Line());
}

// Reads a program line by line. InputError if it cannot be read to its end or is empty: part of a
// program must not be corrected.
class ProgramLines {
 public:
  explicit ProgramLines(const std::filesystem::path& path)
      : name_(path.string()), in_(path, std::ios::binary), buffer_(kLongestLine) {
    if (!in_) throw InputError(name_ + ": cannot be read; check the path");
  }

  bool Next(std::string_view& line) {
    errno = 0;
    in_.getline(buffer_.data(), buffer_.size());
    if (in_.bad()) {
      throw InputError(fmt::format("{}: cannot be read beyond line {}: {}; nothing was written",
                                   name_, lines_, std::strerror(errno == 0 ? EIO : errno)));
    }
    const std::size_t taken = in_.gcount();
    if (in_.fail() && taken > 0) {
      throw InputError(fmt::format("{}: line {}: longer than {} characters; is it an NC program?",
                                   name_, lines_ + 1, kLongestLine - 2));
    }
    if (in_.fail()) {
      if (lines_ == 0) throw InputError(name_ + ": is empty; name an NC program");
      return false;
    }
    ++lines_;
    line = {buffer_.data(), taken - (in_.eof() ? 0 : 1)};
    return true;
  }

 private:
  std::string name_;
  std::ifstream in_;
  std::vector<char> buffer_;
  std::size_t lines_ = 0;
};

// Runs a step of the correction and adds the file to its failures.
template <typename Step>
void InFile(const CorrectCommand& options, Step step) {
  try {
    step();
  } catch (const InputError& failure) {
    throw InputError(fmt::format("{}: {}", options.from.string(), failure.what()));
  }
}

// Line by line, so that a program may be larger than the memory.
void StreamProgram(const CorrectCommand& options, compensation::NcCorrection& correction) {
  ProgramLines lines(options.from);
  recording::WholeFile out(OutOf(options));
  std::string text;
  for (std::string_view line; lines.Next(line);) {
    InFile(options, [&] { correction.Take(line, text); });
    if (text.size() < kBuffer) continue;
    out.Append(text);
    text.clear();
  }
  InFile(options, [&] { correction.Finish(); });
  out.Append(text);
  out.Finish();
}

std::vector<std::string> AssumedIn(const compensation::NcCounts& counts) {
  std::vector<std::string> assumed;
  for (const compensation::NcAssumption& one : counts.assumed) {
    assumed.push_back(fmt::format("{} from line {} on", one.what, one.line));
  }
  return assumed;
}

// The control may be in other modes than assumed when it starts the program.
void Warn(const CorrectCommand& options, const compensation::NcCounts& counts) {
  if (!counts.assumed.empty()) {
    fmt::print(
        stderr,
        "abbe: {}: assumed, because it does not state them: {}; write them into the program\n",
        options.from.string(), fmt::join(AssumedIn(counts), ", "));
  }
  if (!counts.has_end) {
    fmt::print(stderr, "abbe: {}: ends with neither M2, M30 nor %; is it complete?\n",
               options.from.string());
  }
}

void CorrectProgram(const CorrectCommand& options, const map::ErrorMap& map,
                    const compensation::Corrector& corrector) {
  compensation::NcOptions nc;
  nc.limits.chord = options.chord_um * 1e-6;
  nc.limits.length = options.length_mm > 0.0 ? options.length_mm * 1e-3
                                             : LineLength(corrector, map.model(), kLineTolerance);
  nc.work_offset = VectorOf(options.work_offset_mm);
  if (!options.start_mm.empty()) nc.start = VectorOf(options.start_mm);
  compensation::NcCorrection correction(corrector, nc);
  StreamProgram(options, correction);
  const auto& counts = correction.counts();
  Warn(options, counts);
  if (!options.json.empty()) {
    auto result = ResultOf(options, map, "program", counts.largest);
    result.update({{"lines", counts.lines},
                   {"moves", counts.moves},
                   {"corrected", counts.corrected},
                   {"assumed", AssumedIn(counts)},
                   {"line_mm", nc.limits.length * 1e3},
                   {"chord_um", options.chord_um}});
    WriteResult(result, options.json);
  }
  if (options.quiet) return;
  fmt::print("{}: {} lines, {} moves written as {}, corrected by up to {:.3g} um\n",
             OutOf(options).string(), counts.lines, counts.moves, counts.corrected,
             counts.largest * 1e6);
  fmt::print("lines up to {:.3g} mm, arcs in chords within {:.3g} um\n", nc.limits.length * 1e3,
             nc.limits.chord * 1e6);
}

int Correct(const CorrectCommand& options) {
  const map::ErrorMap map = options.map.Read();
  compensation::Corrector corrector(map, options.map.Tool(map));
  if (!options.zero_mm.empty()) corrector.KeepZero(VectorOf(options.zero_mm));
  if (options.from.extension() == ".csv") {
    CorrectCsv(options, map, corrector);
  } else if (!options.causes.path.empty()) {
    throw InputError(fmt::format(
        "{}: --causes is for measured coordinates (.csv); set backlash and lag of a program in the "
        "controller",
        options.from.string()));
  } else {
    CorrectProgram(options, map, corrector);
  }
  return kDone;
}

}  // namespace

void AddCorrect(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<CorrectCommand>();
  CLI::App* command = program.add_subcommand(
      "correct", "Corrects measured coordinates (.csv) or an NC program by an error map");
  options->map.AddTo(*command);
  command
      ->add_option("file", options->from, "A table with x_mm, y_mm, z_mm (.csv), or an NC program")
      ->required();
  AddPathCauses(*command, options->causes, options->feed_mm_min);
  command->add_option("--out", options->out, "The corrected file (NAME_corrected beside it)");
  command
      ->add_option("--work-offset", options->work_offset_mm,
                   "Programs: axis positions of the program's zero, x,y,z in mm (0,0,0)")
      ->delimiter(',')
      ->expected(3);
  command
      ->add_option("--start", options->start_mm,
                   "Programs: position of the machine at the start, x,y,z in mm of the program")
      ->delimiter(',')
      ->expected(3);
  command
      ->add_option("--zero", options->zero_mm,
                   "Keep the zero that was touched off at these axis positions, x,y,z in mm")
      ->delimiter(',')
      ->expected(3);
  command->add_option("--chord-um", options->chord_um, "Arcs: largest distance of a chord (1)")
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--length-mm", options->length_mm,
                   "Longest line (default: for a deviation of at most 0.1 um from the map)")
      ->check(CLI::PositiveNumber);
  command->add_option("--json", options->json, "What was corrected, as data");
  command->add_flag("--quiet", options->quiet, "Print nothing but warnings");
  command->footer("Example: abbe correct out/map.toml part.ngc --work-offset 30,30,20");
  command->callback([options, &exit_code] { exit_code = Correct(*options); });
}

}  // namespace abbe::apps
