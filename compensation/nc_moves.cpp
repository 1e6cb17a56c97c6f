#include "compensation/nc_moves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "compensation/nc_cycles.h"

namespace abbe::compensation {
namespace {

using Eigen::Vector3d;

bool ActsAfterTheMove(const NcWord& word) {
  if (word.letter != 'M') return false;
  const int code = CodeTimes10(word);
  return code == 0 || code == 10 || code == 20 || code == 300 || code == 600;
}

bool IsLineComment(const NcWord& word) { return word.text.starts_with(';'); }

bool IsPosition(char letter) {
  return (letter >= 'X' && letter <= 'Z') || (letter >= 'A' && letter <= 'C');
}

// Words that the corrected move replaces.
bool IsReplaced(const NcWord& word, bool with_values) {
  if (IsPosition(word.letter) || (word.letter >= 'I' && word.letter <= 'K')) return true;
  if (word.letter == 'R' || word.letter == '@' || word.letter == '^') return true;
  if (with_values && (word.letter == 'P' || word.letter == 'Q' || word.letter == 'L')) return true;
  if (word.letter != 'G') return false;
  const int code = CodeTimes10(word);
  return code == 0 || code == 10 || code == 20 || code == 30 || code == 800 || code == 530 ||
         code == 280 || code == 300 || IsCycle(code);
}

bool IsArc(int motion) { return motion == 20 || motion == 30; }

}  // namespace

void NcMoves::MustReach(const Vector3d& wanted) const {
  static_cast<void>(corrector_.Command(state_.wanted.ToMachine(wanted)));
}

void NcMoves::Assume(bool needs_plane) {
  const auto assume = [this](bool& is_assumed, NcGroup group, const char* what) {
    if (is_assumed || state_.words.contains(group)) return;
    counts_.assumed.push_back({what, line_number_});
    is_assumed = true;
  };
  assume(assumed_.units, NcGroup::kUnits, "millimetres (G21)");
  assume(assumed_.distances, NcGroup::kDistance, "absolute positions (G90)");
  if (needs_plane) assume(assumed_.plane, NcGroup::kPlane, "arcs and cycles in XY (G17)");
  if (IsCycle(state_.motion)) {
    assume(assumed_.retract, NcGroup::kRetract, "cycles that end at R (G99)");
  }
}

Vector3d NcMoves::Target(const NcMeaning& meaning) {
  const double unit = state_.Unit();
  const auto length = [&](int k) {
    return unit * *meaning.axes[k] / (k == 0 && state_.is_diameter ? 2.0 : 1.0);
  };
  Vector3d target = state_.place;
  if (meaning.is_g53) {
    Vector3d machine = state_.wanted.ToMachine(target);
    for (int k = 0; k < 3; ++k) {
      if (meaning.axes[k]) machine[k] = length(k);
    }
    return state_.wanted.ToProgram(machine);
  }
  for (int k = 0; k < 3; ++k) {
    if (!meaning.axes[k]) continue;
    target[k] = length(k) + (state_.is_relative ? state_.place[k] : 0.0);
  }
  if (!meaning.polar_radius && !meaning.polar_angle) return target;
  if (!state_.is_known[0] || !state_.is_known[1]) {
    Refuse("a polar position (@ ^) while the place in X and Y is unknown; begin with G0 X and Y");
  }
  if (state_.plane != 17) Refuse("a polar position (@ ^) outside the plane XY (G17)");
  const double angle = std::atan2(state_.place.y(), state_.place.x());
  const double radius = std::hypot(state_.place.x(), state_.place.y());
  if (!meaning.polar_angle && radius == 0.0) Refuse("@ without ^ from the origin");
  constexpr double kDegrees = std::numbers::pi / 180.0;
  const double to_radius = meaning.polar_radius ? unit * *meaning.polar_radius : 0.0;
  const double to_angle = meaning.polar_angle ? kDegrees * *meaning.polar_angle : 0.0;
  const bool adds = state_.is_relative;
  const double r = meaning.polar_radius ? to_radius + (adds ? radius : 0.0) : radius;
  const double a = meaning.polar_angle ? to_angle + (adds ? angle : 0.0) : angle;
  target.head<2>() = Eigen::Vector2d(r * std::cos(a), r * std::sin(a));
  return target;
}

Arc NcMoves::ArcOf(const NcMeaning& meaning) const {
  const double unit = state_.Unit();
  Arc arc{state_.plane, state_.motion == 20, state_.place, {}};
  const auto [u, v, w] = AxesOfPlane(state_.plane);
  if (meaning.centre[w]) {
    Refuse(fmt::format("{} does not belong to an arc in G{}", "IJK"[w], state_.plane));
  }
  const bool has_centre = meaning.centre[u] || meaning.centre[v];
  if (has_centre == meaning.radius.has_value()) Refuse("an arc takes either I, J, K or R");
  if (meaning.p) {
    arc.turns = *meaning.p;
    if (!(arc.turns >= 1.0 && arc.turns < kMostLines) || arc.turns != std::round(arc.turns)) {
      Refuse(fmt::format("P {:.9g} is no number of turns of an arc", arc.turns));
    }
  }
  if (meaning.radius) {
    arc.radius = unit * *meaning.radius;
    return arc;
  }
  for (const int k : {u, v}) {
    const auto& given = meaning.centre[k];
    if (state_.centre_is_absolute && !given) {
      Refuse("an arc in G90.1 takes both coordinates of its centre");
    }
    if (given) arc.centre[k] = unit * *given + (state_.centre_is_absolute ? 0.0 : state_.place[k]);
  }
  return arc;
}

// Ends and extremes are checked before a path is divided: a wrong unit would make a thousand times
// as many points.
void NcMoves::Divide(const NcPiece& move) {
  points_.clear();
  if (move.motion == 0) {
    points_.push_back(move.to);
  } else if (!move.IsArc()) {
    if (!((move.to - move.from).norm() <= options_.limits.length)) MustReach(move.to);
    AddLine(move.from, move.to, options_.limits, move.line_number, points_);
  } else {
    for (const Vector3d& point : Extremes(move.from, move.to, move.arc, move.line_number)) {
      MustReach(point);
    }
    AddArc(move.from, move.to, move.arc, options_.limits, move.line_number, points_);
  }
}

void NcMoves::WriteWords(const NcBlock& block) {
  const bool has_values = IsArc(state_.motion) || IsCycle(state_.motion);
  const bool has_cutter =
      std::any_of(block.words.begin(), block.words.end(),
                  [](const NcWord& word) { return word.letter != 'D' && IsOfBeside(word); });
  for (const NcWord& word : block.words) {
    if (has_cutter && IsOfBeside(word)) continue;
    if (IsReplaced(word, has_values) || ActsAfterTheMove(word) || IsLineComment(word)) continue;
    if (word.letter == 'F' && state_.HasInverseFeed() && state_.motion != 0) continue;
    writer_.Word(TextOf(word, line_number_));
  }
}

void NcMoves::WriteStops(const NcBlock& block) {
  for (const NcWord& word : block.words) {
    if (ActsAfterTheMove(word) || IsLineComment(word)) writer_.Word(word.text);
  }
  writer_.EndLine();
}

// All but the end of the last line.
void NcMoves::WritePath(int motion) {
  writer_.Motion(motion);
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (i > 0) writer_.EndLine();
    writer_.Position(state_.wanted.ToMachine(points_[i]));
    WriteAngles(i);
    if (state_.HasInverseFeed() && motion != 0) {  // a line is a part of the time
      writer_.Word(fmt::format("F{:.6g}", inverse_feed_ * static_cast<double>(points_.size())));
    }
  }
}

// The rotary axes turn evenly along the points.
void NcMoves::WriteAngles(std::size_t index) {
  const double count = static_cast<double>(points_.size());
  for (int k = 0; k < 3; ++k) {
    if (!turns_[k]) continue;
    const auto millionths = [&](double part) {
      return std::llround(1e6 * (turn_from_[k] + part * (*turns_[k] - turn_from_[k])));
    };
    const double index_of = static_cast<double>(index);
    const std::int64_t to = millionths((index_of + 1.0) / count);
    const std::int64_t from = state_.is_relative ? millionths(index_of / count) : 0;
    writer_.Angle("ABC"[k], to - from);
  }
}

// A line with G53, since the offsets of rotary axes are the control's.
void NcMoves::WriteInMachine(const NcMeaning& meaning) {
  if (points_.size() > 1) {
    Refuse(
        "the move in machine coordinates (G53) is divided; turn A, B and C in a line of their own");
  }
  writer_.Word("G53");
  writer_.Motion(state_.motion);
  writer_.Position(state_.wanted.ToMachine(points_.front()), true);
  for (int k = 0; k < 3; ++k) {
    if (meaning.rotary[k]) writer_.Angle("ABC"[k], std::llround(1e6 * *meaning.rotary[k]));
    state_.rotary[k] = kRuntime;
  }
}

// Takes the rotary axes of a block whose points are known.
void NcMoves::TakeAngles(const NcMeaning& meaning) {
  turns_ = meaning.rotary;
  for (int k = 0; k < 3; ++k) {
    if (!turns_[k]) continue;
    turn_from_[k] = state_.is_relative ? 0.0 : state_.rotary[k];
    if (std::isnan(turn_from_[k])) {
      if (points_.size() > 1) {
        Refuse(
            fmt::format("the move is divided, but where {} stands is not known; write {} in a G0 "
                        "before it",
                        "ABC"[k], "ABC"[k]));
      }
      turn_from_[k] = *turns_[k];
    }
    state_.rotary[k] = *turns_[k] + (state_.is_relative ? state_.rotary[k] : 0.0);
  }
}

// A line or an arc as programmed.
void NcMoves::MoveAlong(const NcBlock& block, const NcMeaning& meaning, const Vector3d& target) {
  NcPiece move{state_.motion, line_number_, state_.stands.value_or(state_.place), target};
  if (move.IsArc()) {
    if (state_.stands) Refuse("an arc right after G40; let a line lead away first");
    move.arc = ArcOf(meaning);
  }
  Divide(move);
  const bool turns_in_machine = meaning.is_g53 && meaning.HasRotary();
  if (!turns_in_machine) TakeAngles(meaning);
  state_.place = target;
  state_.stands.reset();
  WriteWords(block);
  turns_in_machine ? WriteInMachine(meaning) : WritePath(state_.motion == 0 ? 0 : 10);
  WriteStops(block);
}

void NcMoves::Move(const NcBlock& block, const NcMeaning& meaning, std::size_t line_number) {
  line_number_ = line_number;
  const int motion = state_.motion;
  if (motion == kNoMotion) Refuse("axis words without G0, G1, G2 or G3 in force");
  if (meaning.is_g53 && motion != 0 && motion != 10) Refuse("G53 belongs to G0 and G1");
  if ((meaning.HasCentre() && !IsArc(motion)) ||
      (meaning.radius && !IsArc(motion) && !IsCycle(motion))) {
    Refuse("I, J, K and R belong to an arc");
  }
  const bool has_path_mode = meaning.HasMode(640);
  constexpr int kDwell = 40;
  if (meaning.nonmodal == kDwell) {
    // LinuxCNC moves only where the block says how.
    if (meaning.motion == kNoMotion) Refuse("a dwell together with a move without its G0 or G1");
    writer_.InForce(kNoMotion);
  }
  const bool has_own_p = has_path_mode || meaning.nonmodal != kNoMotion;
  if (meaning.p && has_own_p && motion > 10) {
    Refuse("P belongs to G64, G4 or to the move; write them in two lines");
  }
  const bool is_plain = motion == 0 || motion == 10;
  if ((meaning.l || (meaning.q && !has_path_mode)) && !IsCycle(motion)) {
    Refuse("L and Q belong to a cycle");
  }
  if (meaning.p && is_plain && !has_own_p) Refuse("P is not supported here");
  std::array<bool, 3> known = state_.is_known;
  for (int k = 0; k < 3; ++k) {
    if (meaning.axes[k] && (!state_.is_relative || meaning.is_g53)) known[k] = true;
  }
  const bool was_known = state_.KnowsPlace(), is_known = known[0] && known[1] && known[2];
  const bool adds_to_unknown = state_.is_relative && !meaning.is_g53 &&
                               ((meaning.axes[0] && !known[0]) || (meaning.axes[1] && !known[1]) ||
                                (meaning.axes[2] && !known[2]));
  if ((!was_known && motion != 0) || adds_to_unknown || (!is_known && state_.wanted.IsTurned())) {
    Refuse(
        "moves while the position of the machine is unknown; begin with G0 to X, Y and Z in G90, "
        "or give the start with --start x,y,z");
  }
  Assume(IsArc(motion) || IsCycle(motion));
  if (!is_known) {
    Approach(block, meaning);
    ++counts_.moves;
    return;
  }
  if (state_.HasInverseFeed() && motion != 0) {
    if (IsCycle(motion)) Refuse("a cycle in G93");
    if (!meaning.feed || !(*meaning.feed > 0.0)) Refuse("a move in G93 takes F above 0");
    inverse_feed_ = *meaning.feed;
  }
  turns_ = {};
  if (IsCycle(motion)) {
    if (meaning.HasRotary()) Refuse("a rotary axis in a cycle");
    WriteCycle(block, meaning);
    WriteStops(block);
  } else if (state_.IsBeside()) {
    MoveBeside(block, meaning, Target(meaning));
  } else {
    MoveAlong(block, meaning, Target(meaning));
  }
  state_.is_known = known;
  ++counts_.moves;
}

}  // namespace abbe::compensation
