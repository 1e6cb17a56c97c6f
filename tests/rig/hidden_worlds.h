// Worlds with something hidden and nothing else wrong: exact machine, no noise, even temperatures.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rig/hidden_effect.h"
#include "rig/record_course.h"
#include "tests/rig/demo_rig.h"

namespace abbe::rig {

inline const Sensors& DemoSensors() {
  static const Sensors sensors{{"temp_column_c", "temp_table_c"}, "temp_table_c"};
  return sensors;
}

inline HiddenEffects Hide(const std::vector<std::string>& texts, std::uint64_t seed = 1) {
  HiddenEffects hidden;
  for (const std::string& text : texts) hidden.push_back(ParseHidden(text, seed, DemoSensors()));
  return hidden;
}

inline LinkageSettings PerfectLinkage() {
  LinkageSettings linkage = ReadLinkage(DemoMill().Root());
  linkage.link = linkage.pivot_angle = linkage.pivot_offset = linkage.encoder_offset = 0.0;
  linkage.eccentricity = linkage.graduation = linkage.bearing = linkage.base_place = 0.0;
  linkage.base_angle = linkage.ball = linkage.compliance = linkage.thermal = 0.0;
  linkage.encoder_noise = linkage.reference_noise = 0.0;
  return linkage;
}

// The encoders so fine that what a count rounds does not matter.
inline RigSettings PerfectMachine() {
  RigSettings machine = PerfectRig();
  machine.cap = 0.0;
  machine.encoder_counts = 1e12;
  return machine;
}

inline LinkageRig PerfectLinkageRig(const HiddenEffects& hidden) {
  return {World(PerfectMachine(), 1, hidden), Linkage(PerfectLinkage(), 1, hidden)};
}

// Reference minus scale of an axis in each row, m.
inline std::vector<double> Deviations(const recording::Recording& path, char axis) {
  const auto scale = path.At(std::string{axis} + "_mm");
  const auto reference = path.At("ref_" + std::string{axis} + "_mm");
  std::vector<double> deviations;
  for (std::size_t i = 0; i < scale.size(); ++i) {
    deviations.push_back(1e-3 * (reference[i] - scale[i]));
  }
  return deviations;
}

}  // namespace abbe::rig
