// A sweep as the simulation sees it: what the five probes said at which position of the swept axis.
//
//   const SweepRun run = ReadSweepRun(recording, head, noise);
//
// Station means: one row is the mean of all dwells at one station and in one direction of approach,
// with the covariance that white noise and drift leave, as the passes show them, and without moves
// of the zeros (probes/sweep_stations.h): what a sweep of
// any length says of the machine, kept in a few hundred numbers. Dwells: one row is one dwell, in
// the order of time, to show what changes from pass to pass; the covariance is that of the machine
// file's drift and the scatter within the dwells. Gap steps: at some stations the axes that stand
// in a sweep step by a known way, which moves every gap.
// Frames: positions as the control counts; gaps of the probes.
// Units: m. Shapes: one entry or column per row; covariance rows x rows for each probe.
// Failure: InputError for a recording that is no sweep or has fewer than three stations.
// Source: probes/sweep_stations.h for the means and their covariance.
// Validity: a mean over passes hides what changes from pass to pass; dwells show it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "probes/channel_order.h"
#include "probes/head_settings.h"
#include "recording/blocks.h"
#include "recording/recording.h"

namespace abbe::simulation {

// How head and target were set up, as the header says.
struct SweepMounting {
  bool head_turned = false;      // by half a turn about n
  double target_shift = 0.0;     // m, along u
  bool target_reversed = false;  // each face by half a turn about its normal, in the middle of what
                                 // the head passes
  probes::ChannelOrder channels = probes::kAsNamed;  // cables of two probes exchanged
};

// InputError for a head that is neither.
SweepMounting MountedOf(const recording::Recording& recording);

struct SweepRun {
  std::string name;      // of the recording, for messages
  std::string mounting;  // header `mounting`: sweeps that share it share the mounted target
  SweepMounting mounted = {};
  char axis = 'X';
  Eigen::Vector3d start;        // [x y z] when the sweep began
  Eigen::Matrix3Xd steps = {};  // of the other axes from the start, in each row; or empty
  Eigen::Matrix<double, 6, 3> slopes = Eigen::Matrix<double, 6, 3>::Zero();  // ReadGapSteps
  Eigen::VectorXd position;                                                  // of the swept axis
  Eigen::VectorXd time;                 // s, of each row, or of its first dwell
  Eigen::VectorXd samples, duration;    // readings in each row, s from the first to the last
  std::vector<int> pass;                // 0: a mean over passes
  std::vector<int> direction;           // +1, -1
  std::vector<std::size_t> first_rows;  // of the recording: of the first dwell of each row
  Eigen::Matrix<double, probes::kProbes, Eigen::Dynamic> gap;  // as read
  probes::PerProbe<Eigen::MatrixXd> covariance;                // m^2
  std::vector<std::string> notes = {};                         // what was taken out of the readings

  Eigen::Index rows() const { return position.size(); }
  // [x y z] of all axes in a row.
  Eigen::Vector3d AxesAt(Eigen::Index row) const {
    Eigen::Vector3d axes = start;
    if (steps.cols() > 0) axes += steps.col(row);
    axes[axis - 'X'] = position[row];
    return axes;
  }
};

// Station means of a whole recording.
SweepRun ReadSweepRun(const recording::Recording& recording, const probes::HeadSettings& head,
                      const probes::ProbeNoise& noise);
// For a run of any length: `recording` needs no rows.
SweepRun ReadSweepRun(const recording::Recording& recording, const recording::Blocks& blocks,
                      const probes::HeadSettings& head, const probes::ProbeNoise& noise);
// A recording that holds still (kind dwell): one row is one of the first kStillReadings readings,
// then the mean of so many that at most kLaterBlocks rows hold all the others.
inline constexpr std::size_t kStillReadings = 120, kLaterBlocks = 100;
// Nothing steps and nothing sweeps.
SweepRun ReadStillReadings(const recording::Recording& recording, const probes::ProbeNoise& noise);
// Single readings of a sweep while it stands (stays.h), the first ones, each stay about a mean that
// nobody knows: what they say of mains and vibration beyond the means of ReadSweepDwells.
SweepRun ReadReadingsInStays(const recording::Recording& recording,
                             const std::vector<std::vector<std::size_t>>& stays,
                             const probes::ProbeNoise& noise);
// Dwells, as above.
SweepRun ReadSweepDwells(const recording::Recording& recording, const probes::HeadSettings& head,
                         const probes::ProbeNoise& noise);
// Gap steps (kind gap-steps): one row is one standstill, whichever axis stepped to it. `slopes`:
// standard deviation of the slope of each error motion of X, Y, Z over a step, 1 and rad/m.
SweepRun ReadGapSteps(const recording::Recording& recording, const probes::ProbeNoise& noise,
                      const Eigen::Matrix<double, 6, 3>& slopes);

}  // namespace abbe::simulation
