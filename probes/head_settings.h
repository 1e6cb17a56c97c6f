// The head, the target and the probes' noise as the machine file describes them.
//
//   const auto document = settings::Document::Read("machine.toml");
//   const HeadSettings head = ReadHeadSettings(document.Root());
//
// Frames: H, the head frame (u, s, n) of head_layout.h; M, the machine frame.
// Units: SI. Shapes: one value per probe, in the order A, B, C, D, E; one frame per swept axis.
// Failure: InputError with file, line and key, also for an unknown key in one of these tables.
// docs/machine-file.md lists every key.
// Source: own; what the numbers mean in head_model.h, installation.h and electrode.h.
// Validity: a default is stated in `assumed` where it changes a result.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <set>
#include <string>

#include "machine/machine.h"
#include "probes/electrode.h"
#include "probes/head_layout.h"
#include "probes/installation.h"
#include "settings/document.h"

namespace abbe::probes {

struct ProbeSettings {
  double range;                    // m: the largest gap
  std::optional<double> zero_gap;  // m: gap at the start; without it the mean of the first station
  double gain;                     // change of the reading = gain * Delta
};

// Standard deviations that remain after manufacture and mounting.
struct HeadTolerance {
  double probe_position;   // m
  double installation;     // rad
  double offset;           // m, of the installation
  double gain;             // relative
  double linearity = 0.0;  // m: of each probe's departure from its straight characteristic
};

// The pose of the head frame in the machine for the sweep of one axis.
struct AxisFrame {
  Eigen::Matrix3d R_MH;  // columns u, s, n
  Eigen::Vector3d p_MH;  // m: the origin of H when the sweep starts
};

struct HeadSettings {
  HeadLayout<> layout;
  PerProbe<ProbeSettings> probes;
  Electrode electrode;
  Installation<> installation;
  HeadTolerance tolerance;
  std::array<AxisFrame, 3> axes;  // of the sweeps of X, Y, Z
  // Missing keys whose defaults affect results: "head.axis_X.position_mm".
  std::set<std::string> assumed;

  // The largest gap of each probe, m.
  PerProbe<> Ranges() const {
    PerProbe<> ranges;
    for (std::size_t i = 0; i < kProbes; ++i) ranges[i] = probes[i].range;
    return ranges;
  }
  // The frame for the sweep of `axis`, 'X', 'Y' or 'Z', else InputError.
  const AxisFrame& Frame(char axis) const { return axes[machine::AxisIndex(axis)]; }
};

// The factor to which a stated size is known where neither data nor the file say more.
inline constexpr double kKnownTo = 2.0;

struct TargetSettings {
  double form;           // m: standard deviation of the flatness of a face
  double form_known_to;  // the factor to which that is known; 1: measured
  double form_length;    // m: its correlation length
  double squareness;     // rad: side face against top face, from its certificate
  double u_squareness;   // rad: standard uncertainty of that
};

struct ProbeNoise {
  double probe;       // m: standard deviation of one reading of one probe
  double drift;       // m: standard deviation of its drift
  double drift_time;  // s: its correlation time
  // Where recordings tell, of each channel: white noise of one reading, m; a part of it that goes
  // on from one reading to the next, m, and for how long, s. Else 0.
  PerProbe<> measured = {}, memory = {}, memory_time = {};

  // m, one reading: as measured, else as stated.
  double Of(std::size_t probe_index) const {
    return measured[probe_index] > 0.0 ? measured[probe_index] : probe;
  }
};

// [head] and its sub-tables.
HeadSettings ReadHeadSettings(const settings::Table& root);
// [target].
TargetSettings ReadTargetSettings(const settings::Table& root);
// [noise]: the keys of the probes.
ProbeNoise ReadProbeNoise(const settings::Table& root);

}  // namespace abbe::probes
