#include "compensation/nc_moves.h"
#include "failure/failure.h"

namespace abbe::compensation {

using Eigen::Vector3d;

// A move with G41 or G42: its words now, its path when the move after it has shown where it ends.
void NcMoves::MoveBeside(const NcBlock& block, const NcMeaning& meaning, const Vector3d& target) {
  if (!beside_.IsOn()) beside_.Begin(state_.beside, state_.place);
  NcPiece move{state_.motion, line_number_, state_.place, target};
  if (move.IsArc()) move.arc = WithCentre(move.from, target, ArcOf(meaning), line_number_);
  beside_.Add(move, [this](const auto& pieces) { FillGap(pieces); });
  state_.place = target;
  WriteWords(block);
  writer_.LeaveGap();
  WriteStops(block);
}

void NcMoves::FillGap(const std::vector<NcPiece>& pieces) {
  writer_.BeginGap();
  for (const NcPiece& piece : pieces) {
    if (&piece != &pieces.front()) writer_.EndLine();
    try {
      Divide(piece);
      WritePath(piece.motion == 0 ? 0 : 10);
    } catch (const InputError& failure) {  // that names the line of a later block
      const std::string_view what = failure.what();
      if (what.starts_with("line ")) throw;
      RefuseLine(piece.line_number, std::string(what));
    }
  }
  writer_.EndGap();
}

void NcMoves::EndBeside() {
  if (beside_.IsOn()) {
    beside_.Finish([this](const auto& pieces) { FillGap(pieces); });
    state_.stands = beside_.at();
  }
  state_.beside.side = 0.0;
}

}  // namespace abbe::compensation
