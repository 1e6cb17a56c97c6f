// The study of one's own head: what its tolerances in the machine file leave of a sweep.
//
// A world is a head as it may have been made and mounted, a machine of the population, and the
// means of its readings: exact readings of that head (RigidReadings), inverted as if it were
// nominal. Errors are estimated minus true at stations over the planned sweep, an angle from the
// first of them, a straightness from its line, as in a sweep. Five factors are drawn by themselves:
// motion of the axis, positions of the probes, installation, gains, and noise: what all readings at
// a station leave of the white part, and the passes of the drift.
//
// A row has the errors of two independent worlds and of the first with one factor of the second
// (Saltelli's design); the share of a factor is the total index of
// estimation/sobol_indices.h, the stations as its outputs.
// Frames: H of probes/head_layout.h. Units: rad, m. Shapes: 5 x stations, rows roll, pitch, yaw,
// straightness along s, along n.
// Failure: InputError for a machine file without this axis or without [head].
// Source: Kweon, Liu, Yang (docs/theory-head.md), section 6, for the question; Saltelli et al.,
// Computer Physics Communications 181 (2010), for the indices.
// Validity: rigid head and target, electrodes that see a point; form of the target and drift are
// left out.
#pragma once

#include "study/study.h"

namespace abbe::study {

extern const StudyKind kHeadStudy;

}  // namespace abbe::study
