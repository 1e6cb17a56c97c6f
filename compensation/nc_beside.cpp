#include "compensation/nc_beside.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <optional>

#include "compensation/nc_block.h"

namespace abbe::compensation {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kStraight = 0.05;  // rad, a corner that is none; LinuxCNC's

Vector2d TurnedLeft(const Vector2d& d) { return {-d.y(), d.x()}; }

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

double SweepOf(const NcPiece& piece) {
  return Sweep(piece.from, piece.to, piece.arc, piece.line_number);
}

// The point of a circle on a line at `sign` of its two distances from the foot of the centre.
std::optional<Vector2d> Meet(const Vector2d& centre, double radius, const Vector2d& point,
                             const Vector2d& direction, double sign) {
  const Vector2d foot = point + direction * direction.dot(centre - point);
  const double square = radius * radius - (centre - foot).squaredNorm();
  if (square < 0.0) return std::nullopt;
  return foot + sign * std::sqrt(square) * direction;
}

// The point of two circles on the side of `near` of the line through their centres.
std::optional<Vector2d> Meet(const Vector2d& a, double radius_a, const Vector2d& b, double radius_b,
                             const Vector2d& near) {
  const double distance = (b - a).norm();
  if (distance == 0.0) return std::nullopt;
  const Vector2d along = (b - a) / distance;
  const double part =
      (distance * distance + radius_a * radius_a - radius_b * radius_b) / (2.0 * distance);
  const double square = radius_a * radius_a - part * part;
  if (square < 0.0) return std::nullopt;
  const double side = Cross(along, near - a) < 0.0 ? -1.0 : 1.0;
  return a + part * along + side * std::sqrt(square) * TurnedLeft(along);
}

}  // namespace

void NcBeside::Begin(const NcBesideSetting& setting, const Vector3d& place) {
  setting_ = setting;
  const auto axes = AxesOfPlane(setting.plane);
  u_ = axes[0];
  v_ = axes[1];
  w_ = axes[2];
  at_ = place;
  is_on_ = is_first_ = true;
}

Vector2d NcBeside::InPlane(const Vector3d& p) const { return {p[u_], p[v_]}; }

Vector3d NcBeside::WithNormal(const Vector2d& p, double normal) const {
  Vector3d place;
  place[u_] = p.x();
  place[v_] = p.y();
  place[w_] = normal;
  return place;
}

Vector2d NcBeside::Offset(const Vector2d& p, const Vector2d& direction) const {
  return p + setting_.side * setting_.radius * TurnedLeft(direction);
}

double NcBeside::InsideOf(const NcPiece& move) const {
  return move.arc.is_clockwise ? -setting_.side : setting_.side;
}

Vector2d NcBeside::DirectionAt(const NcPiece& move, const Vector3d& place) const {
  if (!move.IsArc()) return (InPlane(move.to) - InPlane(move.from)).normalized();
  const Vector2d left = TurnedLeft(InPlane(place) - InPlane(move.arc.centre)).normalized();
  return move.arc.is_clockwise ? Vector2d(-left) : left;
}

NcBeside::Curve NcBeside::CurveOf(const NcPiece& move, const Vector2d& corner) const {
  const Vector3d place = WithNormal(corner, 0.0);
  const Vector2d direction = DirectionAt(move, place), centre = InPlane(move.arc.centre);
  const double inside = InsideOf(move);
  return {move.IsArc(),
          Offset(corner, direction),
          direction,
          centre,
          (corner - centre).norm() - inside * setting_.radius,
          inside};
}

void NcBeside::MustFit(const NcPiece& move) const {
  const double radius = (InPlane(move.to) - InPlane(move.arc.centre)).norm();
  if (InsideOf(move) > 0.0 && radius <= setting_.radius) {
    RefuseLine(move.line_number,
               "the tool does not fit into the arc; take a smaller one, or let the CAM system "
               "write tool centre paths");
  }
}

// A move that the corners leave nothing of would go back: an arc becomes longer.
void NcBeside::MustAdvance(const NcPiece& piece, double slack) const {
  bool goes_back = false;
  if (piece.IsArc()) {
    goes_back = std::abs(SweepOf(piece)) > whole_sweep_ + slack;
  } else {
    goes_back = (InPlane(piece.to) - InPlane(piece.from)).dot(whole_direction_) <= 0.0;
  }
  if (goes_back) {
    RefuseLine(piece.line_number,
               "the tool does not fit between the corners of this move; take a smaller one, or let "
               "the CAM system write tool centre paths");
  }
}

// A full circle whose ends are not quite one place beside it would not be made.
void NcBeside::MustTurn(const NcPiece& piece) const {
  if (piece.IsArc() && whole_sweep_ - std::abs(SweepOf(piece)) > std::numbers::pi) {
    RefuseLine(piece.line_number,
               "a circle that begins and ends at places that differ by rounding beside it: the "
               "control may leave it out; write it as two arcs");
  }
}

// The first move, from beside no path.
void NcBeside::Enter(const NcPiece& move) {
  const Vector2d from = InPlane(at_), to = InPlane(move.to);
  NcPiece entry = move;
  entry.from = at_;
  if ((to - from).norm() <= setting_.radius) {
    RefuseLine(move.line_number,
               "the first move after G41 or G42 must be longer than the radius of the tool, in the "
               "plane of its compensation");
  }
  if (move.IsArc()) MustFit(move);
  const Vector2d direction = DirectionAt(move, move.to), end = Offset(to, direction);
  entry.to = WithNormal(end, move.to[w_]);
  last_ = move;
  if (move.IsArc()) {  // around the point of the normal at the end that is as far from both
    const Vector2d normal = TurnedLeft(direction), chord = from - end;
    const double along = normal.dot(chord);
    const double signed_radius = chord.squaredNorm() / (2.0 * along);
    const bool turns_left = signed_radius > 0.0;
    if (!std::isfinite(signed_radius) || turns_left == move.arc.is_clockwise) {
      RefuseLine(move.line_number,
                 "the first arc after G41 or G42 does not lead beside its end; begin with a line");
    }
    entry.arc.centre = WithNormal(end + signed_radius * normal, 0.0);
    entry.arc.turns = move.arc.turns;
    last_.arc.centre = entry.arc.centre;
  }
  whole_direction_ = (end - from).normalized();
  if (move.IsArc()) whole_sweep_ = std::abs(SweepOf(entry));
  open_ = {{entry}};
  at_ = entry.to;
  is_first_ = false;
}

// `turn`: to the side away from the tool, from -pi / 2 to 3 pi / 2.
bool NcBeside::IsConcave(double turn) const {
  if (turn < -kStraight || turn > std::numbers::pi + kStraight) return true;
  // Back along the outside of an arc: over it, not around its end.
  return turn > std::numbers::pi - kStraight && last_.IsArc() && InsideOf(last_) < 0.0;
}

// The end of the moves that are open, where the next begins.
void NcBeside::EndAt(const Vector2d& place) {
  NcPiece& moved = open_.front().back();
  moved.to = WithNormal(place, moved.to[w_]);
  MustAdvance(moved, setting_.slack);
  for (std::size_t i = 1; i < open_.size(); ++i) {
    NcPiece& along_normal = open_[i].back();
    along_normal.from = WithNormal(place, along_normal.from[w_]);
    along_normal.to = WithNormal(place, along_normal.to[w_]);
  }
  at_ = WithNormal(place, at_[w_]);
}

std::optional<Vector2d> NcBeside::Meeting(const Curve& a, const Curve& b, const Vector2d& corner) {
  if (a.is_arc && b.is_arc) return Meet(a.centre, a.radius, b.centre, b.radius, corner);
  if (a.is_arc) return Meet(a.centre, a.radius, b.point, b.direction, -a.inside);
  if (b.is_arc) return Meet(b.centre, b.radius, a.point, a.direction, b.inside);
  const double part = Cross(b.point - a.point, b.direction) / Cross(a.direction, b.direction);
  return a.point + part * a.direction;
}

// Around a corner away from the tool, before `move`.
NcPiece NcBeside::Around(const NcPiece& move) const {
  const Vector2d corner = InPlane(move.from);
  const bool is_left = setting_.side > 0.0;
  const int code = is_left ? 20 : 30;
  NcPiece around{move.motion == 0 ? 0 : code, move.line_number, at_,
                 WithNormal(Offset(corner, DirectionAt(move, move.from)), at_[w_])};
  around.arc.plane = setting_.plane;
  around.arc.is_clockwise = is_left;
  around.arc.centre = WithNormal(corner, 0.0);
  return around;
}

void NcBeside::Follow(const NcPiece& move, const Use& use) {
  if (move.IsArc()) MustFit(move);
  const Vector2d corner = InPlane(move.from);
  const Vector2d before = DirectionAt(last_, last_.to), after = DirectionAt(move, move.from);
  double turn = -setting_.side * std::atan2(Cross(before, after), before.dot(after));
  if (turn < -std::numbers::pi / 2) turn += 2 * std::numbers::pi;
  const bool is_concave = IsConcave(turn);
  if (is_concave) {
    const auto meeting = Meeting(CurveOf(last_, corner), CurveOf(move, corner), corner);
    if (!meeting) {
      RefuseLine(move.line_number,
                 "the tool does not fit into the corner before this move; take a smaller one, or "
                 "let the CAM system write tool centre paths");
    }
    EndAt(*meeting);
  } else {
    MustTurn(open_.front().back());
  }
  for (const auto& pieces : open_) use(pieces);
  std::vector<NcPiece> pieces;
  if (!is_concave && turn > kStraight) {
    pieces.push_back(Around(move));
    at_ = pieces.back().to;
  }
  NcPiece own = move;
  own.from = at_;
  own.to = WithNormal(Offset(InPlane(move.to), DirectionAt(move, move.to)), move.to[w_]);
  whole_direction_ = after;
  if (move.IsArc()) whole_sweep_ = std::abs(SweepOf(move));
  MustAdvance(own, 2 * kStraight);
  pieces.push_back(own);
  at_ = own.to;
  last_ = move;
  open_ = {std::move(pieces)};
}

void NcBeside::Add(const NcPiece& move, const Use& use) {
  if (is_first_) return Enter(move);
  if (move.IsArc() || InPlane(move.from) != InPlane(move.to)) return Follow(move, use);
  NcPiece along_normal = move;
  along_normal.from = at_;
  at_[w_] = move.to[w_];
  along_normal.to = at_;
  open_.push_back({along_normal});
}

void NcBeside::Finish(const Use& use) {
  if (!open_.empty()) {
    MustTurn(open_.front().back());
    MustAdvance(open_.front().back(), setting_.slack);
  }
  for (const auto& pieces : open_) use(pieces);
  open_.clear();
  is_on_ = false;
}

}  // namespace abbe::compensation
