#include "compensation/nc_correction.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "compensation/nc_comment.h"
#include "compensation/nc_cycles.h"
#include "compensation/nc_flow.h"
#include "compensation/nc_meaning.h"
#include "compensation/nc_moves.h"
#include "compensation/nc_setup.h"
#include "compensation/nc_state.h"
#include "failure/failure.h"
#include "failure/located.h"

namespace abbe::compensation {
namespace {

using Eigen::Vector3d;

constexpr std::string_view kMark = "(corrected by abbe with the map ";

// #5599: whether the control shows (debug, ...) comments; it stays in the program.
constexpr int kDebugComments = 5599;

class ProgramCorrection : public NcHost {
 public:
  ProgramCorrection(Corrector corrector, const NcOptions& options, NcSource& source, NcSink write)
      : corrector_(std::move(corrector)),
        options_(options),
        source_(source),
        parameters_(LiveOf(state_, options_.tables), options_.tables.parameters),
        writer_(corrector_, state_, options.most_lines, std::move(write)),
        moves_(corrector_, options_, state_, writer_, counts_),
        setup_(corrector_, options_, state_, writer_) {
    if (!(options_.limits.chord > 0.0) || !(options_.limits.length > 0.0)) {
      throw InputError("the chord tolerance and the length of a line must be above 0");
    }
    state_.wanted = OffsetsOf(options_.tables);
    if (!options_.tables.parameters) state_.wanted.systems[0] = options_.work_offset;
    state_.control = state_.wanted;
    for (int axis = 0; axis < 3; ++axis) state_.is_known[axis] = !corrector_.Has(axis);
    if (!options_.start) return;
    Located("--start", [&] { moves_.MustReach(*options_.start); });
    state_.place = *options_.start;
    writer_.StandAt(state_.wanted.ToMachine(state_.place));
    state_.is_known.fill(true);
  }

  NcCounts Run() {
    counts_.lines = source_.main().starts.size();
    RefuseCorrected();
    if (!BeginsWithPercent()) WriteMark();
    RunProgram(source_, parameters_, *this);
    Close();
    writer_.Flush();
    counts_.corrected = writer_.positions();
    counts_.largest = writer_.largest();
    return counts_;
  }

  bool Take(std::string_view line, std::size_t line_number) override {
    line_number_ = line_number;
    try {
      ReadBlock(line, line_number, parameters_, block_);
      return Act(line);
    } catch (const InputError& failure) {
      const std::string_view what = failure.what();
      if (what.starts_with("line ")) throw;
      RefuseLine(line_number, std::string(what));
    }
  }

  bool Deletes(std::size_t line_number) override {
    if (!options_.deletes_blocks) {
      RefuseLine(line_number,
                 "a block that the control may leave out (/); say which with --block-delete on or "
                 "off");
    }
    return *options_.deletes_blocks;
  }

  void TakeKept(std::string_view line, std::size_t line_number, bool is_last) override {
    line_number_ = line_number;
    ReadBlock(line, line_number, parameters_, block_);
    if (block_.is_deletable && Deletes(line_number)) return;
    const NcMeaning meaning = MeaningOf(block_, line_number, options_.allowed);
    const bool forgets =
        std::all_of(block_.settings.begin(), block_.settings.end(), [&](const NcSetting& setting) {
          return is_last &&
                 NcParameters::IsOfSubroutine(setting.parameter.name, setting.parameter.number);
        });
    if (!forgets || !LeavesNothing(block_, options_.allowed.copied)) {
      Refuse(
          "whether this acts is known only at the control; there only messages, stops, waits and "
          "outputs may stand; give --parameters or --ini, or correct the ways apart");
    }
    CopyLine(line, meaning);
    for (const NcSetting& setting : block_.settings) Set(setting);
  }

  void WriteKept(std::string_view line) override {
    has_acted_ = true;
    writer_.Word(line);
    writer_.EndLine();
  }

  void Enter() override { levels_.push_back({}); }

  void Leave(std::size_t line_number) override {
    const Level level = std::move(levels_.back());
    levels_.pop_back();
    if (level.restores && level.kept) Restore(*level.kept, line_number);
  }

  std::size_t MostSteps() const override { return options_.most_steps; }

 private:
  // What M70 and M73 keep, a level of calls each.
  struct Level {
    std::optional<NcModalWords> kept;
    bool restores = false;
  };

  [[noreturn]] void Refuse(const std::string& what) const { RefuseLine(line_number_, what); }

  void RefuseCorrected() const {
    if (options_.corrects_again) return;
    const NcFile& main = source_.main();
    const std::size_t at = main.text.find(kMark);
    if (at == std::string::npos) return;
    const auto line = std::upper_bound(main.starts.begin(), main.starts.end(), at);
    RefuseLine(line - main.starts.begin(),
               "the program is corrected already; correct the original, or add --again to correct "
               "what is left by another map");
  }

  // % must stand first.
  bool BeginsWithPercent() const {
    const std::string& text = source_.main().text;
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    return first != std::string::npos && text[first] == '%';
  }

  void WriteMark() {
    if (options_.mark.empty()) return;
    writer_.Word(options_.mark);
    writer_.EndLine();
  }

  // The block of `line`; false at the end of the program.
  bool Act(std::string_view line) {
    if (block_.is_deletable && Deletes(line_number_)) return true;
    const bool is_percent = IsPercent(line);
    const bool opens = is_percent && !has_begun_;
    if (opens) is_open_ = true;
    if (is_percent && has_begun_) counts_.has_end = true;
    if (is_percent && has_begun_ && is_open_) ended_by_percent_ = true;
    has_begun_ = has_begun_ || line.find_first_not_of(" \t\r") != std::string_view::npos;
    const NcMeaning meaning = MeaningOf(block_, line_number_, options_.allowed);
    has_acted_ = has_acted_ || (meaning.acts && !meaning.is_end) || !block_.settings.empty();
    if (meaning.context != kNoMotion) {
      ActOnContext(meaning);
    } else {
      if (meaning.HasMode(400)) moves_.EndBeside();
      setup_.TakeModes(block_, meaning, line_number_);
      ActOnMotion(line, meaning);
    }
    if (opens) WriteMark();
    for (const NcSetting& setting : block_.settings) {
      if (setting.parameter.number == kDebugComments) continue;
      Set(setting);
    }
    counts_.has_end = counts_.has_end || meaning.is_end;
    if (meaning.is_end) line_of_end_ = line_number_;
    return !meaning.is_end && !(is_percent && ended_by_percent_);
  }

  static bool IsPercent(std::string_view line) {
    const std::size_t first = line.find_first_not_of(" \t");
    return first != std::string_view::npos && line[first] == '%';
  }

  void Set(const NcSetting& setting) {
    if (!setting.parameter.name.empty()) {
      parameters_.SetNamed(setting.parameter.name, setting.value);
    } else {
      parameters_.SetNumber(setting.parameter.number, setting.value);
    }
  }

  void ActOnContext(const NcMeaning& meaning) {
    const bool is_alone =
        block_.settings.empty() &&
        std::all_of(block_.words.begin(), block_.words.end(), [](const NcWord& word) {
          return word.letter == 'M' || word.letter == 'N' || word.letter == '(';
        });
    if (state_.IsBeside()) Refuse("M70 to M73 between G41 or G42 and G40");
    if (!is_alone)
      Refuse("M70 to M73 together with other words; write them in a line of their own");
    Level& level = levels_.back();
    constexpr int kForget = 71, kRestore = 72;
    if (meaning.context == kRestore) {
      if (!level.kept) Refuse("M72 without M70 before it");
      Restore(NcModalWords(*level.kept), line_number_);
      return;
    }
    level.kept = meaning.context == kForget ? std::nullopt : std::optional(state_.words);
    if (meaning.context > kRestore) level.restores = true;
  }

  void Restore(const NcModalWords& before, std::size_t line_number) {
    for (const std::string& line : Restoring(before, NcModalWords(state_.words))) {
      Take(line, line_number);
    }
  }

  void ActOnMotion(std::string_view line, const NcMeaning& meaning) {
    constexpr int kDwell = 40;
    const bool takes_axes = meaning.nonmodal != kNoMotion && meaning.nonmodal != kDwell;
    const bool is_dynamic_length = meaning.HasMode(431);
    const bool is_arc = state_.motion == 20 || state_.motion == 30;
    const bool moves =
        (meaning.HasAxes() || meaning.HasRotary() || (is_arc && meaning.HasCentre())) &&
        !takes_axes && !is_dynamic_length;
    if (moves) return moves_.Move(block_, meaning, line_number_);
    if (IsCycle(meaning.motion)) Refuse("a cycle without X, Y or Z");
    const bool is_free = takes_axes || is_dynamic_length;
    if (!is_free && (meaning.HasCentre() || meaning.radius)) {
      Refuse("I, J, K and R belong to an arc");
    }
    if (meaning.nonmodal == 280 || meaning.nonmodal == 300) {
      return moves_.GoHome(block_, meaning, meaning.nonmodal == 280 ? 0 : 1, line_number_);
    }
    setup_.TakeOffsets(meaning, line_number_);
    CopyLine(line, meaning);
  }

  // A block that does not move: as it is, or with the values of its expressions.
  void CopyLine(std::string_view line, const NcMeaning& meaning) {
    if (meaning.motion != kNoMotion) {
      constexpr int kCancel = 800;
      writer_.InForce(meaning.motion == kCancel ? kNoMotion : meaning.motion);
    }
    const bool is_literal =
        !block_.is_deletable && !meaning.is_beside && block_.settings.empty() &&
        std::all_of(block_.words.begin(), block_.words.end(), [](const NcWord& word) {
          return word.is_literal && word.text.find('#') == std::string_view::npos &&
                 word.text.find(',') == std::string_view::npos;
        });
    if (is_literal) {
      writer_.Word(line);
      writer_.EndLine();
      return;
    }
    bool is_empty = true;
    for (const NcSetting& setting : block_.settings) {
      if (setting.parameter.number != kDebugComments) continue;
      writer_.Word(fmt::format("#{}={:g}", kDebugComments, setting.value));
      is_empty = false;
    }
    for (const NcWord& word : block_.words) {
      if (meaning.is_beside && IsOfBeside(word)) continue;
      writer_.Word(word.letter == '(' ? CommentText(word.text, line_number_, parameters_)
                                      : TextOf(word, line_number_));
      is_empty = false;
    }
    if (!is_empty) writer_.EndLine();
  }

  // What stands behind M2 or M30 does not act; the last % stays.
  void Close() {
    moves_.EndBeside();
    const NcFile& main = source_.main();
    if (line_of_end_) {
      for (std::size_t i = main.starts.size(); is_open_ && i-- > 0;) {
        const std::string_view line = main.Line(i);
        if (line.find_first_not_of(" \t") == std::string_view::npos) continue;
        if (IsPercent(line) && i > 0) {
          writer_.Word(line);
          writer_.EndLine();
        }
        break;
      }
    }
    if (is_open_ && !counts_.has_end) {
      RefuseLine(main.starts.size(),
                 "the program begins with % and ends with neither %, M2 nor M30: it is truncated; "
                 "fetch it again");
    }
    if (!has_acted_ && !main.subs.empty()) {
      throw InputError(fmt::format(
          "it defines the subroutine O<{}> and moves nothing by itself; correct the program that "
          "calls it, with the folder of this file as --subroutines",
          main.subs.begin()->first));
    }
  }

  Corrector corrector_;
  NcOptions options_;
  NcSource& source_;
  NcState state_;
  NcCounts counts_;
  NcParameters parameters_;
  NcWriter writer_;
  NcMoves moves_;
  NcSetup setup_;
  NcBlock block_;
  std::vector<Level> levels_ = std::vector<Level>(1);
  std::size_t line_number_ = 0;
  std::optional<std::size_t> line_of_end_;
  bool is_open_ = false;  // began with %
  bool has_begun_ = false, has_acted_ = false, ended_by_percent_ = false;
};

}  // namespace

std::string MarkOf(const std::string& map, const std::string& date) {
  std::string name = map;
  std::ranges::replace_if(
      name,
      [](unsigned char c) {
        constexpr std::string_view kOfComments = "();%#";
        return c < ' ' || c > '~' ||
               kOfComments.find(static_cast<char>(c)) != std::string_view::npos;
      },
      '_');
  return fmt::format("{}{}{})", kMark, name, date.empty() ? "" : " of " + date);
}

NcCounts CorrectProgram(const Corrector& corrector, const NcOptions& options, NcSource& source,
                        const NcSink& write) {
  return ProgramCorrection(corrector, options, source, write).Run();
}

}  // namespace abbe::compensation
