// The demonstration machine for the rig's tests, with or without everything that is drawn.
#pragma once

#include "../folders.h"
#include "rig/rig_settings.h"
#include "settings/document.h"

namespace abbe::rig {

inline settings::Document DemoMill() { return settings::Document::Read(DemoMillFile()); }

inline RigSettings DemoRig() { return ReadRigSettings(DemoMill().Root()); }

// Every drawn quantity is exactly nominal: no errors, no tolerances, no form, no noise.
inline RigSettings PerfectRig() {
  RigSettings settings = DemoRig();
  const double smoothness = settings.population.smoothness;
  settings.population = {};
  settings.population.smoothness = smoothness;
  settings.probe_position = settings.installation_angle = settings.installation_offset = 0.0;
  settings.gain = settings.form = settings.white = settings.drift = 0.0;
  settings.target_tilt = settings.gap_setting = settings.temperature_drift = 0.0;
  settings.target_squareness = settings.u_target_squareness = 0.0;
  return settings;
}

}  // namespace abbe::rig
