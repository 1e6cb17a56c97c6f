#include "compensation/nc_meaning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "compensation/nc_cycles.h"

namespace abbe::compensation {
namespace {

bool IsOneOf(int code, std::initializer_list<int> codes) {
  return std::find(codes.begin(), codes.end(), code) != codes.end();
}

constexpr double kMostDegrees = 1e9;

bool IsMotion(int code) { return IsOneOf(code, {0, 10, 20, 30, 800}) || IsCycle(code); }

bool IsNonmodal(int code) {
  return IsOneOf(code, {40, 100, 280, 281, 300, 301, 920, 921, 922, 923});
}

// Groups of which a block has one code at most.
int GroupOf(int code) {
  if (IsMotion(code) && code != 800) return 1;
  if (IsNonmodal(code)) return 0;
  if (IsOneOf(code, {170, 180, 190})) return 2;
  if (IsOneOf(code, {900, 910})) return 3;
  if (IsOneOf(code, {901, 911})) return 4;
  if (IsOneOf(code, {200, 210})) return 6;
  if (IsOneOf(code, {430, 431, 432, 490})) return 8;
  if (IsOneOf(code, {980, 990})) return 10;
  if (IsOneOf(code, {540, 550, 560, 570, 580, 590, 591, 592, 593})) return 12;
  if (IsOneOf(code, {930, 940, 950})) return 5;
  if (IsOneOf(code, {960, 970})) return 14;
  if (IsOneOf(code, {610, 611, 640})) return 13;
  if (IsOneOf(code, {70, 80})) return 15;
  if (IsOneOf(code, {400, 410, 411, 420, 421})) return 7;
  return code == 530 || code == 800 ? code : -1;
}

std::string_view WhyNot(int code) {
  switch (code) {
    case 330:
    case 331:
    case 760:
      return "a thread is geared to the spindle and cannot be split; correct the rest of the program "
             "and keep this part in a program of its own";
    case 740:
    case 840:
      return "tapping is geared to the spindle; drill with the corrected program, tap in a program "
             "of its own";
    case 870:
    case 880:
      return "what this cycle does depends on the control; write its moves out";
    case 382:
    case 383:
    case 384:
    case 385:
      return "where a probe stops is known only at the control; probe in a program of its own and "
             "correct the measured coordinates with abbe correct FILE.csv";
    case 50:
    case 51:
    case 52:
    case 53:
      return "splines are not divided; let the CAM system write lines and arcs";
    case 700:
    case 710:
    case 711:
    case 712:
    case 720:
    case 721:
    case 722:
      return "the passes of a turning cycle are made by the control; let the CAM system write them";
    default:
      return "it cannot be corrected; remove or replace it";
  }
}

bool MayBeCopied(int code_times_10) {
  return code_times_10 % 10 == 0 && code_times_10 >= 10 * kFirstOfUser &&
         code_times_10 <= 10 * kLastOfUser;
}

bool IsKnownM(int code) {
  return code >= 0 && code % 10 == 0 &&
         (code <= 90 || IsOneOf(code / 10, {19, 30, 48, 49, 50, 51, 52, 53, 60, 61, 62,
                                            63, 64, 65, 66, 67, 68, 70, 71, 72, 73}));
}

class Meaning {
 public:
  Meaning(std::size_t line_number, const NcAllowed& allowed)
      : line_number_(line_number), allowed_(allowed) {}

  NcMeaning Of(const NcBlock& block) {
    for (const NcWord& word : block.words) Take(word);
    Check();
    return meaning_;
  }

 private:
  [[noreturn]] void Refuse(const std::string& what) const { RefuseLine(line_number_, what); }

  void Give(NcMeaning::Value& value, const NcWord& word, const char* twice) {
    if (value) Refuse(twice);
    if (std::isnan(word.value)) {
      Refuse(
          fmt::format("{} depends on a value that is known only at the control (a probe, an "
                      "input, a parameter without a value); set it in the program, or name the "
                      "control's parameters with --parameters",
                      word.text));
    }
    value = word.value;
  }

  void TakeG(const NcWord& word) {
    const int code = CodeTimes10(word);
    const int group = GroupOf(code);
    if (group < 0) {
      Refuse(fmt::format("{} is not supported: {}", word.text, WhyNot(code)));
    }
    if (!groups_.insert(group).second) {
      Refuse(fmt::format("{} and another code of its group", word.text));
    }
    if (code == 530) {
      meaning_.is_g53 = true;
    } else if (code == 800) {
      if (meaning_.motion == kNoMotion) meaning_.motion = code;
    } else if (IsMotion(code)) {
      meaning_.motion = code;
    } else if (IsNonmodal(code)) {
      meaning_.nonmodal = code;
    } else {
      meaning_.modes.push_back(code);
    }
    takes_p_ = takes_p_ || code == 40 || code == 100 || code == 640;
    meaning_.is_beside = meaning_.is_beside || IsOneOf(code, {410, 411, 420, 421});
    takes_d_ = takes_d_ || code == 960 || meaning_.is_beside;
    takes_h_ = takes_h_ || code == 430 || code == 432;
  }

  void TakeM(const NcWord& word) {
    const int code = CodeTimes10(word);
    if (code >= 0 && code % 10 == 0 && allowed_.copied.contains(code / 10)) {
      takes_p_ = takes_q_ = true;
      return;
    }
    if (code == 980 || code == 990) {
      Refuse(fmt::format(
          "{}: subroutines of M98 and M99 are not supported; write them as O words (O100 sub, O100 "
          "endsub, O100 call), or put their lines in the place of the call",
          word.text));
    }
    if (!IsKnownM(code) && !MayBeCopied(code)) {
      Refuse(fmt::format("{} is not supported: its effect on the machine is unknown; remove it",
                         word.text));
    }
    if (!IsKnownM(code)) {
      Refuse(
          fmt::format("{} is not supported: its effect on the machine is unknown; remove it, or "
                      "keep it with --copy {} if it does not move the machine",
                      word.text, word.text));
    }
    meaning_.is_end = meaning_.is_end || code == 20 || code == 300;
    meaning_.changes_tool = meaning_.changes_tool || code == 60;
    if (code >= 700 && code <= 730) meaning_.context = code / 10;
    const bool has_values = code == 190 || (code >= 500 && code <= 530) || (code >= 610);
    takes_p_ = takes_p_ || has_values;
    takes_q_ = takes_q_ || has_values;
    takes_l_ = takes_l_ || code == 660;
    takes_e_ = takes_e_ || (code >= 660 && code <= 680);
  }

  void Take(const NcWord& word) {
    meaning_.acts = meaning_.acts || (word.letter != '(' && word.letter != 'N');
    switch (word.letter) {
      case '(':
      case 'N':
      case 'S':
      case 'T':
      case '$':
        return;
      case 'F':
        meaning_.feed = word.value;
        return;
      case 'G':
        return TakeG(word);
      case 'M':
        return TakeM(word);
      case 'X':
      case 'Y':
      case 'Z':
        return Give(meaning_.axes[word.letter - 'X'], word, "an axis is given twice");
      case 'I':
      case 'J':
      case 'K':
        return Give(meaning_.centre[word.letter - 'I'], word, "a word is given twice");
      case '@':
        return Give(meaning_.polar_radius, word, "a word is given twice");
      case '^':
        return Give(meaning_.polar_angle, word, "a word is given twice");
      case 'R':
        return Give(meaning_.radius, word, "a word is given twice");
      case 'L':
        return Give(meaning_.l, word, "a word is given twice");
      case 'H':
        return Give(meaning_.h, word, "a word is given twice");
      case 'D':
        return Give(meaning_.d, word, "a word is given twice");
      case 'P':
        if (std::isnan(word.value)) has_late_p_ = true;  // of a dwell or an output
        if (!std::isnan(word.value)) Give(meaning_.p, word, "a word is given twice");
        return;
      case 'Q':
        return Give(meaning_.q, word, "a word is given twice");
      case 'E':
        has_e_ = true;
        return;
      case 'A':
      case 'B':
      case 'C':
        if (!allowed_.rotary) {
          Refuse(
              fmt::format("{} is not supported: it moves a rotary axis, which is not in the map; "
                          "if it carries the workpiece, --rotary table corrects X, Y and Z and "
                          "leaves it as it is",
                          word.text));
        }
        if (std::abs(word.value) > kMostDegrees) Refuse("a rotary axis turns too far");
        return Give(meaning_.rotary[word.letter - 'A'], word, "an axis is given twice");
      default:
        Refuse(fmt::format("{} is not supported: it cannot be corrected; remove it", word.text));
    }
  }

  // Values whose code is in force from earlier blocks are looked at by the motion.
  void Check() const {
    if (has_e_ && !takes_e_) Refuse("E is not supported here");
    if (meaning_.d && meaning_.is_beside && meaning_.HasMode(960)) {
      Refuse("D belongs to G96 or to G41 and G42; write them in two lines");
    }
    if (meaning_.h && !takes_h_) Refuse("H is not supported here: it belongs to G43");
    if (meaning_.d && !takes_d_) Refuse("D is not supported here");
    if (has_late_p_ && !takes_p_) Refuse("P is known only at the control");
    if (meaning_.p && meaning_.nonmodal != 40 && meaning_.nonmodal != 100 && !takes_p_ &&
        !meaning_.HasAxes() && !meaning_.HasCentre() && !meaning_.HasRotary()) {
      Refuse("P is not supported here");
    }
    if (meaning_.q && !takes_q_ && !meaning_.HasAxes() && meaning_.nonmodal != 100) {
      Refuse("Q is not supported here");
    }
    if (meaning_.l && !takes_l_ && !meaning_.HasAxes() && meaning_.nonmodal != 100) {
      Refuse("L is not supported here");
    }
    if (meaning_.nonmodal == 40 && meaning_.HasCentre()) Refuse("a dwell together with an arc");
    if (meaning_.HasRotary() && !IsOneOf(meaning_.nonmodal, {kNoMotion, 100, 920})) {
      Refuse("A, B and C belong to a move, to G10 or to G92");
    }
    if (meaning_.motion == 800 && meaning_.HasAxes() && meaning_.nonmodal == kNoMotion) {
      Refuse("axis words without G0, G1, G2 or G3 in force (G80)");
    }
    const bool has_polar = meaning_.polar_radius || meaning_.polar_angle;
    if (has_polar && (meaning_.axes[0] || meaning_.axes[1])) {
      Refuse("@ or ^ together with X or Y");
    }
    if (has_polar && (meaning_.nonmodal != kNoMotion || meaning_.is_g53)) {
      Refuse("@ and ^ belong to a move in program coordinates");
    }
  }

  std::size_t line_number_;
  const NcAllowed& allowed_;
  NcMeaning meaning_;
  std::set<int> groups_;
  bool takes_p_ = false, takes_q_ = false, takes_l_ = false, takes_e_ = false, takes_d_ = false,
       takes_h_ = false, has_e_ = false, has_late_p_ = false;
};

// "#<_hal[plasmac.feed]>": the control can read it in the corrected program too.
bool IsOfControl(const NcWord& word) {
  const std::string_view value = word.text.substr(1);
  return value.starts_with("#<_") && value.ends_with('>') && value.find('>') == value.size() - 1;
}

std::optional<NcGroup> ModalGroup(const NcWord& word) {
  if (word.letter == 'F') return NcGroup::kFeed;
  if (word.letter == 'S') return NcGroup::kSpeed;
  const int code = CodeTimes10(word);
  if (word.letter == 'M') {
    if (code == 30 || code == 40 || code == 50) return NcGroup::kSpindle;
    return std::nullopt;
  }
  if (word.letter != 'G') return std::nullopt;
  switch (GroupOf(code)) {
    case 2:
      return NcGroup::kPlane;
    case 3:
      return NcGroup::kDistance;
    case 4:
      return NcGroup::kCentre;
    case 5:
      return NcGroup::kFeedMode;
    case 6:
      return NcGroup::kUnits;
    case 8:
      return NcGroup::kToolLength;
    case 10:
      return NcGroup::kRetract;
    case 12:
      return NcGroup::kSystem;
    case 13:
      return NcGroup::kPath;
    case 14:
      return NcGroup::kSpindleMode;
    case 15:
      return NcGroup::kDiameter;
    default:
      return std::nullopt;
  }
}

}  // namespace

NcMeaning MeaningOf(const NcBlock& block, std::size_t line_number, const NcAllowed& allowed) {
  return Meaning(line_number, allowed).Of(block);
}

bool IsOfBeside(const NcWord& word) {
  return word.letter == 'D' ||
         (word.letter == 'G' && IsOneOf(CodeTimes10(word), {410, 411, 420, 421}));
}

bool LeavesNothing(const NcBlock& block, const std::set<int>& copied) {
  return std::all_of(block.words.begin(), block.words.end(), [&](const NcWord& word) {
    const int code = CodeTimes10(word);
    if (word.letter == 'G') return code == 40;
    if (word.letter != 'M')
      return std::string_view("(NPQLE").find(word.letter) != std::string::npos;
    return IsOneOf(code, {0, 10, 20, 300, 600}) || (code >= 620 && code <= 680) ||
           copied.contains(code / 10);
  });
}

std::string TextOf(const NcWord& word, std::size_t line_number) {
  if (word.is_literal) return std::string(word.text);
  if (std::isnan(word.value)) {
    if (IsOfControl(word)) return std::string(word.text);
    RefuseLine(line_number,
               fmt::format("{} depends on a value that is known only at the control; set it in the "
                           "program, or name the control's parameters with --parameters",
                           word.text));
  }
  std::string number = fmt::format("{:.9f}", word.value);
  number.erase(number.find_last_not_of('0') + 1);
  if (number.ends_with('.')) number.pop_back();
  if (number == "-0") number.erase(0, 1);
  return word.letter + number;
}

void KeepModalWords(const NcBlock& block, std::size_t line_number, NcState& state) {
  for (const NcWord& word : block.words) {
    if (word.letter == 'F') state.feed = word.value;
    if (word.letter == 'S') state.speed = word.value;
    if (word.letter == 'M') {
      const int code = CodeTimes10(word);
      if (code == 70 || code == 90) state.words[NcGroup::kMist] = code == 70 ? "M7" : "M9";
      if (code == 80 || code == 90) state.words[NcGroup::kFlood] = code == 80 ? "M8" : "M9";
    }
    const auto group = ModalGroup(word);
    if (!group) continue;
    std::string text = TextOf(word, line_number);
    // The values that belong to the code.
    for (const NcWord& value : block.words) {
      const bool belongs =
          (*group == NcGroup::kToolLength && (value.letter == 'H' || CodeTimes10(word) == 431) &&
           std::string_view("HXYZ").find(value.letter) != std::string_view::npos) ||
          (*group == NcGroup::kPath && (value.letter == 'P' || value.letter == 'Q')) ||
          (*group == NcGroup::kSpindleMode && (value.letter == 'D' || value.letter == 'S'));
      if (belongs) text += ' ' + TextOf(value, line_number);
    }
    state.words[*group] = text;
  }
}

}  // namespace abbe::compensation
