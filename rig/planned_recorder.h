// Recordings of planned paths on the rig: what the recorder of a chosen run would have written. The machine is switched on when the first path begins.
//
//   PlannedRecorder recorder(ReadCampaignMachine(document.Root()), 7, hidden, started);
//   if (recorder.Records(path)) recorder.Record(path, 3);
//
// A path is a recording of kind sweep, gap-steps, dwell, linkage or length: its positions, times,
// temperatures and header count, its readings do not. What is mounted anew (an id or a base that is
// none of those before) is drawn by the number of the run and gets the id "mounted 3", so that later
// paths can name it.
// Frames: positions as the control counts. Units: s since 1970, columns as their names say.
// The same machine file, seed, hidden effects, path and number give the same recording.
// Failure: InputError for a kind that the rig does not record, or a place out of reach.
// Validity: cables that are swapped at the amplifier are not recorded (Records() is false).
#pragma once

#include <cstdint>
#include <memory>

#include "recording/recording.h"
#include "rig/campaign_machine.h"
#include "rig/climate.h"
#include "rig/hidden_effect.h"
#include "rig/linkage.h"
#include "rig/record_course.h"

namespace abbe::rig {

class PlannedRecorder {
 public:
  // Instants and angles that the effects leave open are drawn in the first hour, and about the
  // middle of the travels.
  PlannedRecorder(CampaignMachine machine, std::uint64_t seed, HiddenEffects hidden,
                  double started);

  // With all values drawn.
  const HiddenEffects& hidden() const { return hidden_; }

  // Whether it can.
  bool Records(const recording::Recording& path) const;
  // `number`: each run has its own noise.
  recording::Recording Record(const recording::Recording& path, std::uint64_t number);

 private:
  struct Run;
  struct Kind;
  static const Kind* KindOf(const recording::Recording& path);
  Mounting MountingOf(const Run& run) const;
  LinkageRig RigOf(const Run& run) const;
  recording::Recording Sweep(const Run& run);
  recording::Recording GapSteps(const Run& run);
  recording::Recording Dwell(const Run& run);
  recording::Recording OfLinkage(const Run& run);
  recording::Recording Ballbar(const Run& run);
  recording::Recording Length(const Run& run);

  CampaignMachine machine_;
  std::uint64_t seed_;
  HiddenEffects hidden_;
  double started_;
  Climate climate_;
};

}  // namespace abbe::rig
