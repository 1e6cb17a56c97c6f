// The middle of a measured circle, and the angles of its points about it.
//
// For a whole turn it is the centre of the least-squares circle, for a part of one that of a circle
// of the nominal radius. The points of a ballbar, which are read in the commanded directions u, are
// turned into those seen from its fixed ball first, c beside the commanded centre: it reads
//
//   |R u - c| + u'e + ...,  and not R - u'c,  which differ by (c x u)^2 / 2R
//
// Frames: as in circle_run.h. Units: m, rad. Shapes: one angle a point.
// Failure: InputError with the recording for points on no circle.
// Source: own. Validity: an offset that is small against the radius.
#pragma once

#include "paths/circle_run.h"

namespace abbe::paths {

// Fills `middle` and the angles; turns the points of a ballbar.
void FindMiddle(CircleRun& run);

}  // namespace abbe::paths
