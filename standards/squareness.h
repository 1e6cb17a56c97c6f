// Squareness of two linear axes after ISO 230-1: the difference of inclination of two reference
// lines.
//
// Frames: each function takes the reference line of axis U's straightness in direction V (the line
// of E_VU over u) and that of axis V's in direction U. The result is the rotation of the later axis
// away from its right angle to the earlier one, positive by the right-hand rule about the third
// axis:
//   C0Y > 0: Y leans towards -X (the angle from +X to +Y is more than 90 degrees),
//   B0Z > 0: Z leans towards +X (the angle from +Z to +X is less than 90 degrees),
//   A0Z > 0: Z leans towards -Y (the angle from +Y to +Z is more than 90 degrees).
// Units: slopes and result in rad. Failure: none.
// Source: ISO 230-1:2012, clause 3 (definition and symbols; not checked against its text); signs
// derived and tested against rotated direction vectors.
// Validity: to first order in the slopes (1 mrad: 1e-9 rad). The figure inherits the kind of line:
// state it. Both lines must be in one frame: a target that is remounted between the two sweeps, or
// whose faces are not square, adds its own angle.
#pragma once

#include "standards/reference_line.h"

namespace abbe::standards {

inline double SquarenessC0Y(const Line& eyx, const Line& exy) { return -eyx.slope - exy.slope; }
inline double SquarenessB0Z(const Line& ezx, const Line& exz) { return ezx.slope + exz.slope; }
inline double SquarenessA0Z(const Line& ezy, const Line& eyz) { return -ezy.slope - eyz.slope; }

}  // namespace abbe::standards
