// abbe correct: correction of measured coordinates or an NC program by an error map.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
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
#include "failure/located.h"
#include "map/text_file.h"
#include "recording/instant.h"
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
  // What a program leaves to its control.
  std::filesystem::path tools, parameters, ini;
  std::string control_units = "mm", block_delete, rotary;
  std::vector<std::filesystem::path> subroutines;
  std::vector<std::string> copied;
  bool again = false;
};

// Largest deviation of a line of commands from the corrected line, if its length is not given.
constexpr double kLineTolerance = 0.1e-6;
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

std::string ReadProgram(const CorrectCommand& options) {
  ProgramLines lines(options.from);
  std::string text;
  for (std::string_view line; lines.Next(line);) {
    if (text.size() > compensation::kLargestProgram) {
      throw InputError(fmt::format("{}: more than {} bytes; split the program",
                                   options.from.string(), compensation::kLargestProgram));
    }
    (text += line) += '\n';
  }
  return text;
}

// As the first line ends, so do all.
bool HasLinesOfWindows(const std::string& text) {
  const std::size_t end = text.find('\n');
  return end != std::string::npos && end > 0 && text[end - 1] == '\r';
}

void AppendLines(std::string_view lines, bool of_windows, recording::WholeFile& out) {
  if (!of_windows) return out.Append(lines);
  std::string text;
  for (const char c : lines) {
    if (c == '\n') text += '\r';
    text += c;
  }
  out.Append(text);
}

// The corrected program is written as it comes, and is not there if it is refused.
compensation::NcCounts StreamProgram(const CorrectCommand& options,
                                     const compensation::Corrector& corrector,
                                     const compensation::NcOptions& nc) {
  std::string text = ReadProgram(options);
  const bool of_windows = HasLinesOfWindows(text);
  recording::WholeFile out(OutOf(options));
  compensation::NcCounts counts;
  Located(options.from.string(), [&] {
    compensation::NcSource source("", std::move(text));
    source.SearchIn(options.from.parent_path());
    for (const auto& folder : options.subroutines) source.SearchIn(folder);
    counts = compensation::CorrectProgram(corrector, nc, source, [&](std::string_view piece) {
      AppendLines(piece, of_windows, out);
    });
  });
  out.Finish();
  return counts;
}

// "M110" as 110.
std::set<int> CopiedCodes(const std::vector<std::string>& words) {
  std::set<int> codes;
  for (const std::string& word : words) {
    int code = -1;
    const char* const end = word.data() + word.size();
    if (word.size() > 1 && (word[0] == 'M' || word[0] == 'm')) {
      const auto [stop, error] = std::from_chars(word.data() + 1, end, code);
      if (error != std::errc() || stop != end) code = -1;
    }
    if (code < compensation::kFirstOfUser || code > compensation::kLastOfUser) {
      throw InputError(fmt::format("--copy {}: not an M code from M100 to M999", word));
    }
    codes.insert(code);
  }
  return codes;
}

compensation::NcTables TablesOf(const CorrectCommand& options) {
  constexpr double kMetresPerMm = 1e-3, kMetresPerInch = 25.4e-3;
  compensation::NcTables tables;
  tables.unit = options.control_units == "inch" ? kMetresPerInch : kMetresPerMm;
  if (!options.tools.empty()) tables.tools = compensation::ReadTools(options.tools);
  if (!options.parameters.empty()) {
    tables.parameters = compensation::ReadParameters(options.parameters);
  }
  if (!options.ini.empty()) tables.ini = compensation::ReadIniNumbers(options.ini);
  return tables;
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
  for (const compensation::NcAssumption& one : counts.uncorrected) {
    fmt::print(stderr, "abbe: {}: copied uncorrected, first in line {}: {}\n",
               options.from.string(), one.line, one.what);
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
  nc.work_offset = VectorOf("--work-offset", options.work_offset_mm);
  if (!options.start_mm.empty()) nc.start = VectorOf("--start", options.start_mm);
  nc.tables = TablesOf(options);
  if (!options.map.tool_mm.empty()) nc.p_TQ_gauge = options.map.Tool(map);
  if (!options.block_delete.empty()) nc.deletes_blocks = options.block_delete == "on";
  nc.allowed.copied = CopiedCodes(options.copied);
  nc.allowed.rotary = !options.rotary.empty();
  nc.corrects_again = options.again;
  nc.mark = compensation::MarkOf(options.map.path.filename().string(),
                                 map.state() ? recording::InstantText(map.state()->time) : "");
  const compensation::NcCounts counts = StreamProgram(options, corrector, nc);
  Warn(options, counts);
  if (!options.json.empty()) {
    auto result = ResultOf(options, map, "program", counts.largest);
    result.update({{"lines", counts.lines},
                   {"moves", counts.moves},
                   {"corrected", counts.corrected},
                   {"assumed", AssumedIn(counts)},
                   {"copied_moves", counts.copied_moves},
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
  if (!options.zero_mm.empty()) corrector.KeepZero(VectorOf("--zero", options.zero_mm));
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
  auto* const work_offset =
      command
          ->add_option("--work-offset", options->work_offset_mm,
                       "Programs: axis positions of the program's zero (G54), x,y,z in mm (0,0,0)")
          ->delimiter(',')
          ->expected(3);
  command
      ->add_option("--parameters", options->parameters,
                   "Programs: the control's parameters: offsets, #31 to #5000 (linuxcnc.var)")
      ->excludes(work_offset);
  command->add_option("--tools", options->tools,
                      "Programs: the control's tool table, for G43 (tool.tbl)");
  command->add_option("--ini", options->ini,
                      "Programs: the control's INI file, for #<_ini[SECTION]KEY> (mill.ini)");
  command
      ->add_option("--control-units", options->control_units,
                   "Programs: units of parameters and tools, mm or inch (mm)")
      ->check(CLI::IsMember({"mm", "inch"}));
  command->add_option("--subroutines", options->subroutines,
                      "Programs: folders of subroutines NAME.ngc besides the program's own");
  command
      ->add_option("--block-delete", options->block_delete,
                   "Programs: blocks that begin with / are left out (on) or run (off)")
      ->check(CLI::IsMember({"on", "off"}));
  command
      ->add_option("--rotary", options->rotary,
                   "Programs: table: A, B, C carry the workpiece, which follows the corrected axes")
      ->check(CLI::IsMember({"table"}));
  command->add_option("--copy", options->copied,
                      "Programs: M codes of the machine's own that do not move it (M110)");
  command->add_flag("--again", options->again,
                    "Programs: correct one that is corrected already, by another map");
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
      ->check(PositiveNumber());
  command
      ->add_option("--length-mm", options->length_mm,
                   "Longest line (default: for a deviation of at most 0.1 um from the map)")
      ->check(PositiveNumber());
  command->add_option("--json", options->json, "What was corrected, as data");
  command->add_flag("--quiet", options->quiet, "Print nothing but warnings");
  command->footer("Example: abbe correct out/map.toml part.ngc --work-offset 30,30,20");
  command->callback([options, &exit_code] { exit_code = Correct(*options); });
}

}  // namespace abbe::apps
