// A machine and the instruments on it, as its machine file describes them.
// Units: SI.
// Failure: InputError for an instrument that the file lacks.
// Source: docs/machine-file.md.
// Validity: `noisy` and `notes` are what the recordings of this call showed.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "machine/machine.h"
#include "probes/head_settings.h"
#include "relm/linkage_settings.h"

namespace abbe::simulation {

// A channel that scatters far more than is stated while nothing moves.
struct NoisyChannel {
  std::string name;  // "probe_a"
  double factor = 1.0, freedom = 0.0;
};

struct Instruments {
  machine::Machine machine;
  std::optional<probes::HeadSettings> head;
  probes::TargetSettings target;
  probes::ProbeNoise noise;  // of the head
  std::optional<relm::LinkageSettings> linkage;
  std::vector<std::string> notes = {};  // where recordings contradict the file
  std::vector<NoisyChannel> noisy = {};

  // A machine file may describe an arm or a shaft and no axes.
  bool HasAxes() const;
  // InputError naming the recording that needs the table [head] or [linkage], if it is missing.
  const probes::HeadSettings& HeadFor(const std::string& recording) const;
  // Likewise for a linkage.
  const relm::LinkageSettings& LinkageFor(const std::string& recording) const;
};

}  // namespace abbe::simulation
