// The study of circles: whether `abbe circle` finds and sizes backlash, and nothing that is not
// there.
//
// A world is a machine of the rig that drives a circle both ways in XY before a grid encoder,
// radius (10 to 25 mm) and feed (300 to 3000 mm/min) by the seed. Its backlash is taken up with
// play; sound axes of the population have none, and no reversal spikes and no servo mismatch.
// Units: um. Failure: InputError for a machine file that the rig cannot be.
// Source: own; the bounds are the coverage of a U95.
// Validity: axis positions without hysteresis of the encoder itself; smooth errors of the
// population.
#pragma once

#include "study/study.h"

namespace abbe::study {

extern const StudyKind kCircleStudy;

}  // namespace abbe::study
