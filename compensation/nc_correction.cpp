#include "compensation/nc_correction.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "failure/failure.h"
#include "settings/unit.h"

namespace abbe::compensation {
namespace {

using Eigen::Vector3d;

constexpr double kInch = 25.4 * settings::kMillimetre;

bool IsStop(const NcWord& word) {
  if (word.letter != 'M') return false;
  const int code = CodeTimes10(word);
  return code == 0 || code == 10 || code == 20 || code == 300 || code == 600;
}

bool IsProgramEnd(const NcWord& word) {
  return word.letter == 'M' && (word.value == 2.0 || word.value == 30.0);
}

bool IsMotionWord(const NcWord& word) {
  if (word.letter != 'G') return false;
  const int code = CodeTimes10(word);
  return code == 0 || code == 10 || code == 20 || code == 30;
}

bool IsKnownM(int code_times_10) {
  return code_times_10 >= 0 && code_times_10 % 10 == 0 &&
         (code_times_10 <= 90 || code_times_10 == 300 || code_times_10 == 480 ||
          code_times_10 == 490 || code_times_10 == 600);
}

// Words that the corrected move replaces.
bool IsOfMove(const NcWord& word) {
  return (word.letter >= 'X' && word.letter <= 'Z') || (word.letter >= 'I' && word.letter <= 'K') ||
         word.letter == 'R' || IsMotionWord(word);
}

std::string_view WhyNot(int code_times_10) {
  switch (code_times_10) {
    case 410:
    case 411:
    case 420:
    case 421:
      return "cutter compensation moves the tool off the programmed path; let the CAM system write "
             "tool centre paths";
    case 430:
    case 431:
    case 432:
      return "a tool length offset changes the tool vector; program the tool point and give its "
             "position with --tool";
    case 930:
      return "inverse time feed depends on the length of the line, which is split; use G94";
    default:
      return "it cannot be corrected; remove or replace it";
  }
}

// A blank between words, none at the start of a line.
void AppendBlank(std::string& out) {
  if (!out.empty() && out.back() != '\n') out += ' ';
}

// `units` of 10^-decimals, e.g. 12500000 with 6 decimals as "12.5". Written from the last digit
// backwards.
void AppendFixed(std::int64_t units, int decimals, std::string& out) {
  std::array<char, 32> text;
  char* const end = text.data() + text.size();
  char* begin = end;
  std::uint64_t digits = units < 0 ? -units : units;
  const auto take_digit = [&] {
    const char digit = static_cast<char>('0' + digits % 10);
    digits /= 10;
    return digit;
  };
  for (int i = 0; i < decimals; ++i) {
    const char digit = take_digit();
    if (begin != end || digit != '0') *--begin = digit;
  }
  if (begin != end) *--begin = '.';
  do {
    *--begin = take_digit();
  } while (digits != 0);
  if (units < 0) *--begin = '-';
  out.append(begin, end);
}

}  // namespace

NcCorrection::NcCorrection(const Corrector& corrector, const NcOptions& options)
    : corrector_(corrector), options_(options) {
  if (!(options_.limits.chord > 0.0) || !(options_.limits.length > 0.0)) {
    throw InputError("the chord tolerance and the length of a line must be above 0");
  }
  if (!options_.start) return;
  try {
    MustReach(*options_.start);
  } catch (const InputError& failure) {
    throw InputError(fmt::format("--start: {}", failure.what()));
  }
  place_ = out_ = *options_.start;
  is_known_.fill(true);
}

void NcCorrection::TakeG(const NcWord& word, Block& block) {
  const int code = CodeTimes10(word);
  switch (code) {
    case 0:
    case 10:
    case 20:
    case 30:
      motion_ = code / 10;
      return;
    case 800:
      motion_ = -1;
      return;
    case 40:
      block.dwells = true;
      return;
    case 170:
    case 180:
    case 190:
      plane_ = code / 10;
      says_.plane = true;
      return;
    case 200:
    case 210:
      is_inch_ = code == 200;
      says_.units = true;
      return;
    case 900:
    case 910:
      is_relative_ = code == 910;
      says_.distances = true;
      return;
    case 901:
    case 911:
      centre_is_absolute_ = code == 901;
      return;
    case 400:
    case 490:
    case 540:
    case 610:
    case 640:
    case 940:
    case 970:
      return;
    default:
      RefuseLine(counts_.lines, fmt::format("{} is not supported: {}", word.text, WhyNot(code)));
  }
}

NcCorrection::Block NcCorrection::Understand() {
  Block block;
  bool has_tolerance = false;
  for (const NcWord& word : words_) {
    switch (word.letter) {
      case 'X':
      case 'Y':
      case 'Z':
        if (block.axes[word.letter - 'X']) RefuseLine(counts_.lines, "an axis is given twice");
        block.axes[word.letter - 'X'] = word.value;
        break;
      case 'I':
      case 'J':
      case 'K':
        block.centre[word.letter - 'I'] = word.value;
        break;
      case 'R':
        block.radius = word.value;
        break;
      case 'P':
        block.has_p = true;
        break;
      case '(':
      case 'N':
      case 'F':
      case 'S':
      case 'T':
        break;
      case 'G':
        has_tolerance = has_tolerance || CodeTimes10(word) == 640;
        TakeG(word, block);
        break;
      case 'M':
        if (!IsKnownM(CodeTimes10(word))) {
          RefuseLine(counts_.lines, fmt::format("{} is not supported: its effect on the machine is "
                                                "unknown; remove it",
                                                word.text));
        }
        break;
      default:
        RefuseLine(counts_.lines, fmt::format("{} is not supported: it cannot be corrected; "
                                              "remove it",
                                              word.text));
    }
  }
  const auto has_any = [](const auto& values) {
    return std::any_of(values.begin(), values.end(), [](const auto& v) { return v.has_value(); });
  };
  block.is_move = has_any(block.axes) || (motion_ >= 2 && has_any(block.centre));
  if (block.has_p && !block.dwells && !has_tolerance)
    RefuseLine(counts_.lines, "P is not supported here");
  RefuseLooseWords(block);
  return block;
}

void NcCorrection::RefuseLooseWords(const Block& block) {
  const bool has_centre = block.centre[0] || block.centre[1] || block.centre[2];
  if (block.is_move && block.dwells) RefuseLine(counts_.lines, "a dwell together with a move");
  if (block.is_move && motion_ < 0) {
    RefuseLine(counts_.lines, "axis words without G0, G1, G2 or G3 in force");
  }
  if ((has_centre || block.radius) && (motion_ < 2 || !block.is_move)) {
    RefuseLine(counts_.lines, "I, J, K and R belong to an arc");
  }
}

Vector3d NcCorrection::Target(const Block& block) {
  const double unit = is_inch_ ? kInch : settings::kMillimetre;
  Vector3d target = place_;
  for (int k = 0; k < 3; ++k) {
    if (!block.axes[k]) continue;
    target[k] = unit * *block.axes[k] + (is_relative_ ? place_[k] : 0.0);
    if (!is_relative_) is_known_[k] = true;
  }
  return target;
}

Arc NcCorrection::ArcOf(const Block& block) const {
  const double unit = is_inch_ ? kInch : settings::kMillimetre;
  Arc arc{plane_, motion_ == 2, place_, {}};
  const auto [u, v, w] = AxesOfPlane(plane_);
  if (block.centre[w]) {
    RefuseLine(counts_.lines, fmt::format("{} does not belong to an arc in G{}", "IJK"[w], plane_));
  }
  const bool has_centre = block.centre[u] || block.centre[v];
  if (has_centre == block.radius.has_value()) {
    RefuseLine(counts_.lines, "an arc takes either I, J, K or R");
  }
  if (block.radius) {
    arc.radius = unit * *block.radius;
    return arc;
  }
  for (const int k : {u, v}) {
    const auto& given = block.centre[k];
    if (centre_is_absolute_ && !given) {
      RefuseLine(counts_.lines, "an arc in G90.1 takes both coordinates of its centre");
    }
    if (given) arc.centre[k] = unit * *given + (centre_is_absolute_ ? 0.0 : place_[k]);
  }
  return arc;
}

void NcCorrection::MustReach(const Vector3d& wanted) const {
  static_cast<void>(corrector_.Command(wanted + options_.work_offset));
}

// Ends and extremes are checked before a path is divided: a wrong unit would
// make a thousand times as many points.
void NcCorrection::Divide(const Block& block, const Vector3d& target) {
  points_.clear();
  if (motion_ == 0) {
    points_.push_back(target);
  } else if (motion_ == 1) {
    if (!((target - place_).norm() <= options_.limits.length)) MustReach(target);
    AddLine(place_, target, options_.limits, counts_.lines, points_);
  } else {
    const Arc arc = ArcOf(block);
    for (const Vector3d& point : Extremes(place_, target, arc, counts_.lines)) MustReach(point);
    AddArc(place_, target, arc, options_.limits, counts_.lines, points_);
  }
}

void NcCorrection::Assume() {
  const auto assume = [this](bool& is_said, const char* what) {
    if (!is_said) counts_.assumed.push_back({what, counts_.lines});
    is_said = true;
  };
  assume(says_.units, "millimetres (G21)");
  assume(says_.distances, "absolute positions (G90)");
  if (motion_ >= 2) assume(says_.plane, "arcs in XY (G17)");
}

void NcCorrection::WritePoint(const Vector3d& wanted, std::string& out) {
  const Vector3d position = wanted + options_.work_offset;
  const Vector3d command = corrector_.Command(position);
  counts_.largest = std::max(counts_.largest, (command - position).norm());
  const int decimals = is_inch_ ? 7 : 6;
  const double unit = is_inch_ ? kInch * 1e-7 : settings::kMillimetre * 1e-6;
  for (int k = 0; k < 3; ++k) {
    const double to = command[k] - options_.work_offset[k];
    const std::int64_t units = std::llround((is_relative_ ? to - out_[k] : to) / unit);
    const double written = units * unit;
    out_[k] = is_relative_ ? out_[k] + written : written;
    AppendBlank(out);
    out += "XYZ"[k];
    AppendFixed(units, decimals, out);
  }
  out += '\n';
  ++counts_.corrected;
}

void NcCorrection::Move(const Block& block, std::string& out) {
  const bool was_known = is_known_[0] && is_known_[1] && is_known_[2];
  const Vector3d target = Target(block);
  const bool is_known = is_known_[0] && is_known_[1] && is_known_[2];
  if (!is_known || (!was_known && motion_ != 0)) {
    RefuseLine(counts_.lines,
               "moves while the position of the machine is unknown; begin with G0 to "
               "X, Y and Z in G90, or give the start with --start x,y,z");
  }
  Assume();
  Divide(block, target);
  place_ = target;
  for (const NcWord& word : words_) {
    if (IsOfMove(word) || IsStop(word) || word.text.starts_with(';')) continue;
    AppendBlank(out);
    out += word.text;
  }
  const int motion = motion_ == 0 ? 0 : 1;
  if (motion_out_ != motion) {
    AppendBlank(out);
    out += motion == 0 ? "G0" : "G1";
    motion_out_ = motion;
  }
  for (const Vector3d& point : points_) WritePoint(point, out);
  out.pop_back();  // words that act after the move, and the end of the line
  for (const NcWord& word : words_) {
    if (!IsStop(word) && !word.text.starts_with(';')) continue;
    out += ' ';
    out += word.text;
  }
  out += '\n';
  ++counts_.moves;
}

void NcCorrection::Finish() const {
  if (is_open_ && !counts_.has_end) {
    RefuseLine(
        counts_.lines,
        "the program begins with % and ends with neither %, M2 nor M30: it is truncated; fetch "
        "it again");
  }
}

void NcCorrection::Take(std::string_view line, std::string& out) {
  ++counts_.lines;
  if (line.ends_with('\r')) line.remove_suffix(1);
  ReadBlock(line, counts_.lines, words_);
  const bool is_percent = words_.empty() && line.ends_with('%');
  if (is_percent && counts_.lines == 1) is_open_ = true;
  const bool is_last = std::any_of(words_.begin(), words_.end(), IsProgramEnd);
  counts_.has_end = counts_.has_end || is_last || (is_percent && counts_.lines > 1);
  const Block block = Understand();
  if (!block.is_move) {
    for (const NcWord& word : words_) {
      if (IsMotionWord(word)) motion_out_ = CodeTimes10(word) / 10;
      if (word.letter == 'G' && CodeTimes10(word) == 800) motion_out_ = -1;
    }
    out.append(line) += '\n';
    return;
  }
  try {
    Move(block, out);
  } catch (const InputError& failure) {
    const std::string_view what = failure.what();
    if (what.starts_with("line ")) throw;
    RefuseLine(counts_.lines, std::string(what));
  }
}

}  // namespace abbe::compensation
