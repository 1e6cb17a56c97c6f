// The 18 error motions of three linear axes and their names after ISO 230-1.
//
// Order everywhere: axis 0, 1, 2 is X, Y, Z; motion 0 to 5 of every axis is the translation along
// x, y, z and the turn about x, y, z, right-handed, in the machine frame. For Y: [EXY EYY EZY EAY
// EBY ECY].
// Frames: M; the motions are those of a carriage at the reference point of the machine.
// Units: m and rad. Error = actual - nominal.
// Source: ISO 230-1:2012, clause 3, for the names; not checked against its text.
// Validity: small turns: [EA EB EC] is a rotation vector, whose parts are turns one after the other
// to second order, 5e-9 rad at 0.1 mrad.
#pragma once

#include <string>

namespace abbe::machine {

inline constexpr int kAxes = 3;
inline constexpr int kMotions = 6;

// "EBX" of axis 0, motion 4.
inline std::string MotionName(int axis, int motion) { return {'E', "XYZABC"[motion], "XYZ"[axis]}; }

// EYX, EZX and their like: a translation across the axis.
inline bool IsStraightness(int axis, int motion) { return motion < 3 && motion != axis; }

}  // namespace abbe::machine
