// Every kind of run that abbe knows, and which one a recording is of.
// Units: those of the recordings.
// Failure: InputError with the recording's name for a kind that is not known or does not do what is
// asked.
// Source: docs/recordings.md lists the kinds.
#pragma once

#include <string>
#include <vector>

#include "simulation/run_kind.h"

namespace abbe::simulation {

// A special case stands before the kind that would take it too: an arm is a linkage without axes,
// a shaft may be recorded as a dwell. Each is a function that a folder defines.
// clang-format off
#define ABBE_RUN_KINDS(KIND) \
  KIND(SweepKind) \
  KIND(ArmKind) \
  KIND(LinkageKind) \
  KIND(ReferenceKind) \
  KIND(BallbarKind) \
  KIND(LengthKind) \
  KIND(PlateKind) \
  KIND(ShaftKind) \
  KIND(DwellKind) \
  KIND(GapStepsKind)
// clang-format on

#define ABBE_DECLARE_KIND(name) const RunKind& name();
ABBE_RUN_KINDS(ABBE_DECLARE_KIND)
#undef ABBE_DECLARE_KIND

// In the order in which they are asked, added ones last.
const std::vector<const RunKind*>& RunKinds();

// The first kind that takes the recording. InputError where none does.
const RunKind& KindOf(const recording::Recording& head);

// Adds a kind of a program that uses the library. Not while others read the list.
void AddRunKind(const RunKind& kind);

// The names of the kinds of which `wanted` holds: "sweep, linkage and shaft".
std::string KindNames(bool (RunKind::*wanted)() const);
// All kinds.
std::string KindNames();

// The simulations of a recording, for an error map. InputError where its kind makes none.
std::vector<SimulatedRun> SimulateForMap(const RunSource& source,
                                         const machine::VolumetricModel& model,
                                         const Instruments& instruments);

// The recording corrected for the causes (correction.h). `origin`: of the model; a recording begins
// its own where it says nothing.
Correction Correct(const recording::Recording& recording, const std::vector<ModelledCause>& causes,
                   const Origin& origin, const Instruments& instruments);

// The path with the readings of a perfect machine (planned_run.h).
recording::Recording Planned(recording::Recording path, const Instruments& instruments);

// Refuses recordings of one kind that do not belong together. Kinds with one recording are not
// read.
void RefuseStrangers(const std::vector<RunSource>& sources, const Instruments& instruments);

}  // namespace abbe::simulation
