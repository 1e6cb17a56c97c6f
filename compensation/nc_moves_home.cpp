#include <algorithm>

#include "compensation/nc_block.h"
#include "compensation/nc_moves.h"

namespace abbe::compensation {

using Eigen::Vector3d;

void NcMoves::CopyUncorrected(const NcBlock& block, bool is_rapid, const char* why) {
  const auto& known = counts_.uncorrected;
  const bool is_new = std::none_of(known.begin(), known.end(),
                                   [&](const NcAssumption& one) { return one.what == why; });
  if (is_new) counts_.uncorrected.push_back({why, line_number_});
  ++counts_.copied_moves;
  const bool has_motion = std::any_of(block.words.begin(), block.words.end(), [](const auto& word) {
    return word.letter == 'G' && CodeTimes10(word) == 0;
  });
  bool needs_motion = is_rapid && !has_motion;
  for (const NcWord& word : block.words) {
    if (word.letter != 'N' && needs_motion) {
      writer_.Motion(0);
      needs_motion = false;
    }
    writer_.Word(TextOf(word, line_number_));
  }
  writer_.EndLine();
}

// A rapid to some axes while the others are not known: it is copied, and makes its own axes known.
void NcMoves::Approach(const NcBlock& block, const NcMeaning& meaning) {
  const NcOffsets& offsets = state_.wanted;
  const Vector3d target = Target(meaning);
  const Vector3d machine = offsets.ToMachine(target);
  Vector3d at = writer_.at();
  for (int k = 0; k < 3; ++k) {
    if (meaning.rotary[k]) state_.rotary[k] = state_.is_relative ? kRuntime : *meaning.rotary[k];
    if (!meaning.axes[k]) continue;
    state_.place[k] = target[k];
    state_.is_known[k] = true;
    at[k] = machine[k];
  }
  CopyUncorrected(block, true, "G0 before the place of X, Y and Z is known");
  writer_.StandAt(at);
  writer_.InForce(0);
}

void NcMoves::GoHome(const NcBlock& block, const NcMeaning& meaning, int home,
                     std::size_t line_number) {
  line_number_ = line_number;
  if (meaning.HasCentre() || meaning.radius) Refuse("I, J, K and R belong to an arc");
  NcOffsets& offsets = state_.wanted;
  std::array<bool, 3> goes;
  for (int k = 0; k < 3; ++k) goes[k] = !meaning.HasAxes() || meaning.axes[k].has_value();
  Assume(false);
  ++counts_.moves;
  const bool is_known = offsets.home_is_known[home];
  if (!is_known || !state_.KnowsPlace()) {
    CopyUncorrected(block, false,
                    is_known ? "G28 or G30 from a place that is not known"
                             : "G28 or G30 to a place that only the control knows (--parameters)");
    const bool is_all = goes[0] && goes[1] && goes[2];
    Vector3d machine = offsets.ToMachine(state_.place), at = writer_.at();
    for (int k = 0; k < 3; ++k) {
      if (!goes[k]) {
        if (offsets.IsTurned()) state_.is_known[k] = false;
        continue;
      }
      state_.is_known[k] = is_known && (is_all || !offsets.IsTurned());
      machine[k] = at[k] = offsets.homes[home][k];
    }
    state_.place = offsets.ToProgram(machine);
    writer_.StandAt(at);
    writer_.InForce(kNoMotion);
    return;
  }
  turns_ = {};
  state_.rotary.fill(kRuntime);
  points_.clear();
  if (meaning.HasAxes()) points_.push_back(Target(meaning));
  Vector3d machine = offsets.ToMachine(points_.empty() ? state_.place : points_.back());
  for (int k = 0; k < 3; ++k) {
    if (goes[k]) machine[k] = offsets.homes[home][k];
  }
  points_.push_back(offsets.ToProgram(machine));
  state_.place = points_.back();
  WriteWords(block);
  WritePath(0);
  WriteStops(block);
}

}  // namespace abbe::compensation
