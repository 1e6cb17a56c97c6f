// The positions and measuring directions of the five probes of the head.
//
// Frame H, the head frame of one sweep: right-handed (u, s, n), u along the sweep, s the outward
// normal of the side surface of the target, n that of its top surface. Its origin lies on the edge
// of the two surfaces when the sweep starts, and the target's own frame coincides with it there.
// The names EAX ... EZX and the letters x, y, z of the source are those of u, s, n.
//
// Three probes A, B, C look along -n on the top surface (n = 0), two probes D, E look along -s on
// the side surface (s = 0). A position is where the measuring line meets the surface when the sweep
// starts, so the height of a probe above the surface plays no part.
//
// Units: m. Shapes: one value per probe, in the order A, B, C, D, E.
// Failure: none; the inversions refuse a layout that does not determine the five errors.
// Source: Kweon, Liu, Yang (docs/theory-head.md), figure 5: A (l, 0), B (0, l), C (0, -l) on top
// and D (0, l''), E (l, l'') on the side, l = 10 mm, l'' = 20 mm.
// Validity: an ideal head: the lines along n and s exactly; installation.h has the head as it is
// mounted.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace abbe::probes {

inline constexpr std::size_t kTopProbes = 3;   // A, B, C
inline constexpr std::size_t kSideProbes = 2;  // D, E
inline constexpr std::size_t kProbes = kTopProbes + kSideProbes;

// One value per probe, in the order A, B, C, D, E.
template <typename T = double>
using PerProbe = std::array<T, kProbes>;

template <typename T>
struct TopPosition {
  T u, s;
};

template <typename T>
struct SidePosition {
  T u, n;
};

template <typename T = double>
struct HeadLayout {
  std::array<TopPosition<T>, kTopProbes> top;     // A, B, C
  std::array<SidePosition<T>, kSideProbes> side;  // D, E
};

// The layout of the source for the arm l and the height l'' of the side probes.
inline HeadLayout<double> NominalLayout(double arm = 10e-3, double side_height = 20e-3) {
  return {{{{arm, 0.0}, {0.0, arm}, {0.0, -arm}}}, {{{0.0, side_height}, {arm, side_height}}}};
}

// The measuring line of one probe: `point` is where it meets the nominal surface, `direction` the
// unit vector along which a reading counts, away from the target. Both in H.
template <typename T = double>
struct MeasuringLine {
  Eigen::Vector3<T> point;
  Eigen::Vector3<T> direction;
};

template <typename T = double>
using MeasuringLines = PerProbe<MeasuringLine<T>>;

// The lines of an ideal head: along n for the top probes, along s for the side probes.
template <typename T>
MeasuringLines<T> LinesOf(const HeadLayout<T>& layout) {
  MeasuringLines<T> lines;
  for (std::size_t i = 0; i < kTopProbes; ++i) {
    lines[i] = {{layout.top[i].u, layout.top[i].s, T(0)}, Eigen::Vector3<T>::UnitZ()};
  }
  for (std::size_t i = 0; i < kSideProbes; ++i) {
    lines[kTopProbes + i] = {{layout.side[i].u, T(0), layout.side[i].n},
                             Eigen::Vector3<T>::UnitY()};
  }
  return lines;
}

}  // namespace abbe::probes
