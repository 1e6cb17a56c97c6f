// The path of the tool's centre beside a programmed path (cutter compensation, G41 and G42).
//
//   NcBeside beside;
//   beside.Begin({1.0, 3e-3, 17}, place);       // on the left, 3 mm off it
//   beside.Add(move, use);                      // hands on the moves whose end is certain now
//   beside.Finish(use);
//
// A move ends `radius` beside its programmed end. A corner away from the tool gets an arc around
// it (a chord in rapids), at a corner towards the tool both moves end where their paths meet; a
// corner of less than 0.05 rad is left as it is. The first move leads from where the tool stands
// beside its end: a line, or the arc that arrives in the direction of the programmed one. A move
// along the normal of the plane goes where the tool is.
// Frames: positions in the program's coordinates. Units: m. Shapes: X, Y, Z.
// Failure: InputError with the line where the tool does not fit: into an arc or a corner, or a
// first move that is not longer than the radius.
// Source: LinuxCNC 2.9, cutter compensation (its user manual, and the calls of rs274); geometry
// derived here. Validity: G17 and G18; tools whose point is their centre.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "compensation/nc_path.h"

namespace abbe::compensation {

// A move as programmed, or a part of one as the tool's centre makes it.
struct NcPiece {
  int motion = 10;  // ten times its code: 0, 10, 20, 30
  std::size_t line_number = 0;
  Eigen::Vector3d from, to;
  Arc arc = {};  // of 20 and 30, with its centre

  bool IsArc() const { return motion == 20 || motion == 30; }
};

struct NcBesideSetting {
  double side = 1.0;  // left of the path; right: -1
  double radius = 0.0;
  int plane = 17;
  double slack = 0.0254;  // rad, by which corners may lengthen an arc; LinuxCNC's, 0.001 in G20
};

class NcBeside {
 public:
  // Gets the pieces of one programmed move, in order.
  using Use = std::function<void(const std::vector<NcPiece>&)>;

  // The tool's centre stands at `place`.
  void Begin(const NcBesideSetting& setting, const Eigen::Vector3d& place);
  // Whether moves were added since.
  bool IsOn() const { return is_on_; }
  void Add(const NcPiece& move, const Use& use);
  // Hands on what is left.
  void Finish(const Use& use);
  // Where the last move leads.
  const Eigen::Vector3d& at() const { return at_; }

 private:
  using Vector2 = Eigen::Vector2d;
  // What the tool's centre follows: a line through `point`, or a circle.
  struct Curve {
    bool is_arc;
    Vector2 point, direction;  // of a line
    Vector2 centre;
    double radius, inside;  // 1: the tool is on the side of the centre; -1: beyond the arc
  };

  Vector2 InPlane(const Eigen::Vector3d& p) const;
  Eigen::Vector3d WithNormal(const Vector2& p, double normal) const;
  Vector2 Offset(const Vector2& p, const Vector2& direction) const;
  double InsideOf(const NcPiece& move) const;
  Vector2 DirectionAt(const NcPiece& move, const Eigen::Vector3d& place) const;
  Curve CurveOf(const NcPiece& move, const Vector2& corner) const;
  void Enter(const NcPiece& move);
  void Follow(const NcPiece& move, const Use& use);
  // Where two paths meet beside the corner of the programmed ones; nothing if they do not.
  static std::optional<Vector2> Meeting(const Curve& a, const Curve& b, const Vector2& corner);
  NcPiece Around(const NcPiece& move) const;
  // Whether the tool must stop before the programmed corner.
  bool IsConcave(double turn) const;
  void EndAt(const Vector2& place);
  void MustFit(const NcPiece& move) const;
  void MustAdvance(const NcPiece& piece, double slack) const;
  void MustTurn(const NcPiece& piece) const;

  NcBesideSetting setting_;
  int u_ = 0, v_ = 1, w_ = 2;
  bool is_on_ = false, is_first_ = true;
  Eigen::Vector3d at_;
  NcPiece last_;  // as programmed; the last that moved in the plane
  // The path of the tool's centre beside a line and an arc, without corners.
  Vector2 whole_direction_ = Vector2::Zero();
  double whole_sweep_ = 0.0;
  // For each programmed move that is not handed on; they end at one place of the plane.
  std::vector<std::vector<NcPiece>> open_;
};

}  // namespace abbe::compensation
