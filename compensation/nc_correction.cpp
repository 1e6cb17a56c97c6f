#include "compensation/nc_correction.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "compensation/nc_cycles.h"
#include "compensation/nc_flow.h"
#include "compensation/nc_meaning.h"
#include "compensation/nc_moves.h"
#include "compensation/nc_state.h"
#include "failure/failure.h"

namespace abbe::compensation {
namespace {

using Eigen::Vector3d;

// #5599: whether the control shows (debug, ...) comments; it stays in the program.
constexpr int kDebugComments = 5599;

constexpr int kShownDecimals = 6;

// "%d", "%f", "%lf" and "%.3f" in a comment that shows values: their decimals. What was taken.
std::size_t TakeFormat(std::string_view text, int& decimals) {
  if (text.starts_with("%d")) {
    decimals = 0;
    return 2;
  }
  for (const std::string_view plain : {"%f", "%lf"}) {
    if (!text.starts_with(plain)) continue;
    decimals = kShownDecimals;
    return plain.size();
  }
  constexpr std::size_t kSize = 4;  // "%.3f"
  if (text.size() < kSize || !text.starts_with("%.") || text[3] != 'f') return 0;
  if (text[2] < '0' || text[2] > '9') return 0;
  decimals = text[2] - '0';
  return kSize;
}

// The comment "(debug, depth #1)" with the value of its parameters; others as they are.
std::string CommentText(std::string_view text, std::size_t line_number,
                        const NcParameters& parameters) {
  std::string start;
  for (const char c : text.substr(0, 8)) {
    if (c != ' ') start += static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
  }
  const bool is_abort = start.starts_with("(abort,");
  if (is_abort) {
    RefuseLine(line_number, fmt::format("the program ends itself here: {}", text.substr(0, 60)));
  }
  if (!start.starts_with("(debug,") && !start.starts_with("(print,") &&
      !start.starts_with("(log,")) {
    return std::string(text);
  }
  std::string out;
  int decimals = kShownDecimals;
  for (std::size_t i = 0; i < text.size();) {
    if (const std::size_t taken = TakeFormat(text.substr(i), decimals); taken > 0) {
      i += taken;
      continue;
    }
    NcCursor cursor(text.substr(i), line_number, parameters);
    if (text[i] != '#') {
      out += text[i++];
      continue;
    }
    try {
      const double value = cursor.Value();
      // What only the control knows, it also shows.
      out += std::isnan(value) ? std::string(text.substr(i, cursor.at()))
                               : fmt::format("{:.{}f}", value, decimals);
      i += cursor.at();
    } catch (const InputError&) {
      out += text[i++];  // no parameter: a sign
    }
  }
  return out;
}

class ProgramCorrection : public NcHost {
 public:
  ProgramCorrection(Corrector corrector, const NcOptions& options, NcSource& source, NcSink write)
      : corrector_(std::move(corrector)),
        options_(options),
        source_(source),
        parameters_(LiveOf(state_, options_.tables), options_.tables.parameters),
        writer_(corrector_, state_, options.most_lines, std::move(write)),
        moves_(corrector_, options_, state_, writer_, counts_) {
    if (!(options_.limits.chord > 0.0) || !(options_.limits.length > 0.0)) {
      throw InputError("the chord tolerance and the length of a line must be above 0");
    }
    state_.wanted = OffsetsOf(options_.tables);
    if (!options_.tables.parameters) state_.wanted.systems[0] = options_.work_offset;
    state_.control = state_.wanted;
    if (!options_.start) return;
    try {
      moves_.MustReach(*options_.start);
    } catch (const InputError& failure) {
      throw InputError(fmt::format("--start: {}", failure.what()));
    }
    state_.place = *options_.start;
    writer_.StandAt(state_.wanted.ToMachine(state_.place));
    state_.is_known.fill(true);
  }

  NcCounts Run() {
    counts_.lines = source_.main().starts.size();
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

  // The block of `line`; false at the end of the program.
  bool Act(std::string_view line) {
    if (block_.is_deletable && Deletes(line_number_)) return true;
    const bool is_percent = IsPercent(line);
    if (is_percent && !has_begun_) is_open_ = true;
    if (is_percent && has_begun_) counts_.has_end = true;
    if (is_percent && has_begun_ && is_open_) ended_by_percent_ = true;
    has_begun_ = has_begun_ || line.find_first_not_of(" \t\r") != std::string_view::npos;
    const NcMeaning meaning = MeaningOf(block_, line_number_, options_.allowed);
    has_acted_ = has_acted_ || (meaning.acts && !meaning.is_end) || !block_.settings.empty();
    if (meaning.context != kNoMotion) {
      ActOnContext(meaning);
    } else {
      ActOnModes(meaning);
      ActOnMotion(line, meaning);
    }
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

  void ActOnModes(const NcMeaning& meaning) {
    TakeTool(meaning);
    for (const int code : meaning.modes) TakeMode(code, meaning);
    KeepModalWords(block_, line_number_, state_);
    if (meaning.motion == kNoMotion) return;
    if (!IsCycle(meaning.motion) || !IsCycle(state_.motion)) {
      state_.cycle_r = state_.cycle_initial = kRuntime;
    }
    if (meaning.motion != state_.motion) {
      state_.cycle_bottom = state_.cycle_peck = state_.cycle_dwell = kRuntime;
    }
    constexpr int kCancel = 800;
    state_.motion = meaning.motion == kCancel ? kNoMotion : meaning.motion;
  }

  void TakeMode(int code, const NcMeaning& meaning) {
    switch (code) {
      case 170:
      case 180:
      case 190:
        state_.plane = code / 10;
        return;
      case 200:
      case 210:
        state_.is_inch = code == 200;
        return;
      case 900:
      case 910:
        state_.is_relative = code == 910;
        return;
      case 901:
      case 911:
        state_.centre_is_absolute = code == 901;
        return;
      case 70:
      case 80:
        state_.is_diameter = code == 70;
        return;
      case 980:
      case 990:
        state_.retracts_to_r = code == 990;
        return;
      case 430:
      case 431:
      case 432:
      case 490:
        return TakeToolLength(code, meaning);
      default:
        break;
    }
    constexpr int kG54 = 540, kG59 = 590;
    if (code >= kG54 && code <= kG59 + 3) {
      const int system = code <= kG59 ? (code - kG54) / 10 : code - kG59 + 5;
      if (!state_.wanted.is_known[system]) {
        Refuse(
            fmt::format("the offset of G{:g} is known only at the control; name its parameter "
                        "file with --parameters",
                        code / 10.0));
      }
      state_.ChangeOffsets([&](NcOffsets& offsets) { offsets.active = system; });
    }
  }

  const NcTool& ToolOf(double number) {
    if (!options_.tables.tools) {
      Refuse("a tool length offset depends on the tool table; name it with --tools tool.tbl");
    }
    const auto found = options_.tables.tools->find(static_cast<int>(number));
    if (number != std::round(number) || found == options_.tables.tools->end()) {
      Refuse(fmt::format("tool {:.9g} is not in the tool table; add it", number));
    }
    return found->second;
  }

  void TakeTool(const NcMeaning& meaning) {
    for (const NcWord& word : block_.words) {
      constexpr double kLargestTool = 1e6;
      const bool is_tool = word.value >= 0.0 && word.value < kLargestTool;
      if (word.letter == 'T') {
        state_.selected.reset();
        if (is_tool) state_.selected = static_cast<int>(word.value);
      }
      if (word.letter == 'M' && CodeTimes10(word) == 610) {
        state_.tool.reset();
        if (meaning.q && *meaning.q >= 0.0 && *meaning.q < kLargestTool) {
          state_.tool = static_cast<int>(*meaning.q);
        }
      }
    }
    if (meaning.changes_tool) state_.tool = state_.selected;
    if (!state_.tool || !options_.tables.tools) return;
    const auto found = options_.tables.tools->find(*state_.tool);
    state_.tool_diameter = found == options_.tables.tools->end() ? 0.0 : found->second.diameter;
  }

  void TakeToolLength(int code, const NcMeaning& meaning) {
    const Vector3d before = state_.wanted.tool;
    Vector3d tool = Vector3d::Zero();
    if (code == 430 || code == 432) {
      if (code == 432) tool = before;
      double number = meaning.h.value_or(0.0);
      if (code == 432 && !meaning.h) Refuse("G43.2 without H");
      if (!meaning.h && !state_.tool) {
        Refuse("G43 without H, and no tool was changed before it (M6); write G43 with H");
      }
      if (!meaning.h) number = *state_.tool;
      if (number != 0.0) tool += options_.tables.unit * ToolOf(number).offset;
    } else if (code == 431) {
      tool = before;
      for (int k = 0; k < 3; ++k) {
        if (!meaning.axes[k]) continue;
        tool[k] = state_.Unit() * *meaning.axes[k] / (k == 0 && state_.is_diameter ? 2.0 : 1.0);
      }
    }
    if (tool != Vector3d::Zero() && !options_.p_TQ_gauge) {
      Refuse(fmt::format(
          "a tool offset of X {:.6g} Y {:.6g} Z {:.6g} mm moves the point at which the errors of "
          "the map act; give with --tool the point of a tool whose length offset is 0",
          1e3 * tool.x(), 1e3 * tool.y(), 1e3 * tool.z()));
    }
    state_.ChangeOffsets([&](NcOffsets& offsets) { offsets.tool = tool; });
    if (options_.p_TQ_gauge) {
      corrector_.SetTool(*options_.p_TQ_gauge - corrector_.signs().cwiseProduct(tool));
    }
  }

  // Lengths of a block that sets offsets; not a number where none is given.
  Vector3d Given(const NcMeaning& meaning) const {
    Vector3d given;
    for (int k = 0; k < 3; ++k) {
      given[k] = kRuntime;
      if (!meaning.axes[k]) continue;
      given[k] = state_.Unit() * *meaning.axes[k] / (k == 0 && state_.is_diameter ? 2.0 : 1.0);
    }
    return given;
  }

  void MustKnow(const NcMeaning& meaning) const {
    for (int k = 0; k < 3; ++k) {
      const bool needs = meaning.axes[k] || state_.wanted.IsTurned();
      if (needs && !state_.is_known[k]) {
        Refuse(
            fmt::format("an offset from the place in {}, which is not known; begin with G0 to X, "
                        "Y and Z in G90, or give the start with --start x,y,z",
                        "XYZ"[k]));
      }
    }
  }

  void TakeG92(int code, const NcMeaning& meaning) {
    const Vector3d given = Given(meaning);
    const Vector3d machine = state_.wanted.ToMachine(state_.place);
    constexpr int kSet = 920, kForget = 921, kSuspend = 922;
    if (code == kSet) {
      MustKnow(meaning);
      state_.wanted.SetG92(machine, given);
      state_.control.SetG92(writer_.at(), given);
    } else {
      for (NcOffsets* offsets : {&state_.wanted, &state_.control}) {
        if (code == kForget) offsets->g92.setZero();
        offsets->g92_acts = code > kSuspend;
      }
    }
    state_.place = state_.wanted.ToProgram(machine);
    state_.rotary.fill(kRuntime);
  }

  void TakeG10(const NcMeaning& meaning) {
    if (meaning.l && *meaning.l != 2.0 && *meaning.l != 20.0) {
      Refuse(
          "G10 L0, L1, L10 and L11 change the tool table of the control; set it there and name "
          "it with --tools");
    }
    if (!meaning.l || !meaning.p) Refuse("G10 takes L and P");
    const double p = *meaning.p;
    if (!(p >= 0.0 && p <= kSystems) || p != std::round(p)) {
      Refuse(fmt::format("G10 P{:.9g}: coordinate systems are P1 to P9, P0 the active one", p));
    }
    const int system = p == 0.0 ? state_.wanted.active : static_cast<int>(p) - 1;
    const Vector3d given = Given(meaning);
    const Vector3d machine = state_.wanted.ToMachine(state_.place);
    const bool is_here = *meaning.l == 20.0;
    if (is_here) MustKnow(meaning);
    const bool is_whole = meaning.axes[0] && meaning.axes[1] && meaning.axes[2];
    for (NcOffsets* offsets : {&state_.wanted, &state_.control}) {
      if (meaning.radius) offsets->rotations[system] = *meaning.radius * std::numbers::pi / 180.0;
      if (is_here) {
        if (meaning.radius) Refuse("G10 L20 with R; set the turn with G10 L2");
        offsets->SetSystem(system, offsets == &state_.wanted ? machine : writer_.at(), given);
      } else {
        for (int k = 0; k < 3; ++k) {
          if (meaning.axes[k]) offsets->systems[system][k] = given[k];
        }
      }
      offsets->is_known[system] = offsets->is_known[system] || is_whole;
    }
    if (state_.wanted.IsTurned() && !state_.KnowsPlace()) state_.is_known.fill(false);
    state_.place = state_.wanted.ToProgram(machine);
    state_.rotary.fill(kRuntime);
  }

  void ActOnMotion(std::string_view line, const NcMeaning& meaning) {
    constexpr int kDwell = 40;
    const bool takes_axes = meaning.nonmodal != kNoMotion && meaning.nonmodal != kDwell;
    const bool is_dynamic_length =
        std::find(meaning.modes.begin(), meaning.modes.end(), 431) != meaning.modes.end();
    const bool is_arc = state_.motion == 20 || state_.motion == 30;
    const bool moves =
        (meaning.HasAxes() || meaning.HasRotary() || (is_arc && meaning.HasCentre())) &&
        !takes_axes && !is_dynamic_length;
    if (moves) return moves_.Move(block_, meaning, line_number_);
    if (meaning.is_g53) Refuse("G53 without X, Y or Z");
    if (IsCycle(meaning.motion)) Refuse("a cycle without X, Y or Z");
    const bool is_free = takes_axes || is_dynamic_length;
    if (!is_free && (meaning.HasCentre() || meaning.radius)) {
      Refuse("I, J, K and R belong to an arc");
    }
    switch (meaning.nonmodal) {
      case 280:
      case 300:
        return moves_.GoHome(block_, meaning, meaning.nonmodal == 280 ? 0 : 1, line_number_);
      case 281:
      case 301:
        TakeHome(meaning.nonmodal == 281 ? 0 : 1);
        break;
      case 100:
        TakeG10(meaning);
        break;
      case 920:
      case 921:
      case 922:
      case 923:
        TakeG92(meaning.nonmodal, meaning);
        break;
      default:
        break;
    }
    CopyLine(line, meaning);
  }

  void TakeHome(int home) {
    if (!state_.KnowsPlace()) {
      Refuse("G28.1 or G30.1 at a place that is not known; begin with G0 to X, Y and Z");
    }
    state_.wanted.homes[home] = state_.wanted.ToMachine(state_.place);
    state_.wanted.home_is_known[home] = true;
  }

  // A block that does not move: as it is, or with the values of its expressions.
  void CopyLine(std::string_view line, const NcMeaning& meaning) {
    if (meaning.motion != kNoMotion) {
      constexpr int kCancel = 800;
      writer_.InForce(meaning.motion == kCancel ? kNoMotion : meaning.motion);
    }
    const bool is_literal =
        !block_.is_deletable && block_.settings.empty() &&
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
      writer_.Word(word.letter == '(' ? CommentText(word.text, line_number_, parameters_)
                                      : TextOf(word, line_number_));
      is_empty = false;
    }
    if (!is_empty) writer_.EndLine();
  }

  // What stands behind M2 or M30 does not act; the last % stays.
  void Close() {
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
  NcBlock block_;
  std::vector<Level> levels_ = std::vector<Level>(1);
  std::size_t line_number_ = 0;
  std::optional<std::size_t> line_of_end_;
  bool is_open_ = false;  // began with %
  bool has_begun_ = false, has_acted_ = false, ended_by_percent_ = false;
};

}  // namespace

NcCounts CorrectProgram(const Corrector& corrector, const NcOptions& options, NcSource& source,
                        const NcSink& write) {
  return ProgramCorrection(corrector, options, source, write).Run();
}

}  // namespace abbe::compensation
