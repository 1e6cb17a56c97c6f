// Division of a straight move or an arc of an NC program into points.
//
// Frames: positions in the program's coordinates, m. Planes: G17 XY, G18 ZX, G19 YZ; from the
// positive third axis the first turns towards the second counter-clockwise (G3).
// Failure: InputError with the line for an impossible arc, and for a move of more than kMostLines
// lines.
// Source: RS 274/NGC (NIST IR 6556), 3.5.3, arcs in centre and in radius form.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace abbe::compensation {

struct PathLimits {
  double chord = 1e-6;  // largest distance of an arc from its chord, m
  double length = 0.0;  // largest length of one line, m
};

inline constexpr double kMostLines = 1e6;  // per move: 1 m in lines of 1 um

// Appends the points after `from` up to and including `to`.
void AddLine(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const PathLimits& limits,
             std::size_t line_number, std::vector<Eigen::Vector3d>& points);

struct Arc {
  int plane = 17;
  bool is_clockwise = false;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // its two coordinates in the plane
  std::optional<double> radius;                      // replaces the centre; negative: over 180 deg
  double turns = 1.0;                                // begun ones: 2 is one more full circle
};

// Appends the points of an arc; a helix if the third coordinate changes. `to` equal to `from`, to
// 1e-9 rad, is a full circle, which needs a centre.
void AddArc(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Arc& arc,
            const PathLimits& limits, std::size_t line_number,
            std::vector<Eigen::Vector3d>& points);

// The angle that an arc turns by, rad; counter-clockwise is positive.
double Sweep(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Arc& arc,
             std::size_t line_number);

// The arc with its centre instead of its radius.
Arc WithCentre(const Eigen::Vector3d& from, const Eigen::Vector3d& to, const Arc& arc,
               std::size_t line_number);

// The end of an arc and its extreme points along the axes of its plane: the arc is inside the
// bounding box of `from` and these.
std::vector<Eigen::Vector3d> Extremes(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                      const Arc& arc, std::size_t line_number);

// The first, second and third axis of a plane: G18 has Z, X, Y.
std::array<int, 3> AxesOfPlane(int plane);

}  // namespace abbe::compensation
