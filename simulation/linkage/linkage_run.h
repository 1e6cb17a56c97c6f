// A run of the linkage as the simulation sees it: where the axes were sent, what the encoders said.
//
//   const LinkageRun run = MeansOfStays(ReadLinkageRun(recording, linkage));
//
// `reference` are axis positions like `commanded`, but as a reference instrument (grid encoder,
// tracker) gives them in the columns ref_x_mm, ref_y_mm, ref_z_mm; a direction without such a
// column has the commanded position and `referenced` false. `reference_sd` is what is stated of
// either in the machine file (linkage.noise), or the column ref_u_um; it is not averaged in a stay.
// Frames: positions as the control counts.
// Units: m, rad, s, K. Shapes: one column or entry per pose; `rows` tells the row of the recording,
// or the first row of a stay, of the whole file also where the recording is a block of it. Rows
// with a flag are left out.
// Failure: InputError with the recording's name for another kind of recording, a missing column, or
// a number that is not finite in a row without a flag; see relm/tip_path.h for the angles.
// Source: own.
// Validity: a stay is a sequence of rows whose commanded position keeps within `window` of that of
// its first row, in a recording that knows its times (the rows of a table are poses of their own,
// however well a robot repeats them); its mean is as good as its rows as long as the errors of the
// linkage do not change over the window.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "relm/linkage_settings.h"

namespace abbe::simulation {

struct LinkageRun {
  std::string name;      // of the recording, for messages
  std::string mounting;  // header mounting.base: runs that share it share the pose of the base
  std::string ball;      // which of several; empty: the one that the machine file states
  std::vector<std::size_t> rows;
  Eigen::VectorXd time;
  Eigen::Matrix3Xd commanded;     // [x y z]
  Eigen::Matrix3Xd reference;     // [x y z]
  Eigen::Matrix3Xd reference_sd;  // standard deviation of each
  std::array<bool, 3> referenced{};
  relm::LinkageReadings readings;
  Eigen::VectorXd samples;  // rows averaged in each pose
  bool one_by_one = false;  // each row was measured for itself: a table that knows no time

  Eigen::Index poses() const { return commanded.cols(); }
};

// Row by row, without the flagged ones.
LinkageRun ReadLinkageRun(const recording::Recording& recording,
                          const relm::LinkageSettings& settings);

// The stays of a run, each as one pose.
inline constexpr double kStayWindow = 5e-6;  // m
// A row in no stay is one of its own.
LinkageRun MeansOfStays(LinkageRun run, double window = kStayWindow);

// Readings with a memory (linkage.noise) tell less in a mean than as many that have none: `samples`
// become those of white noise that would tell as much. `duration`: s, of each stay.
void CountIndependent(const relm::LinkageNoise& noise, const Eigen::VectorXd& duration,
                      LinkageRun& run);

// A run that stands at the given axis positions [x y z], its reference instrument present, before
// any encoder has been read.
LinkageRun RunAt(const Eigen::Matrix3Xd& positions, const relm::LinkageSettings& settings);

// The poses with the given indices, in that order.
LinkageRun Selection(const LinkageRun& run, const std::vector<Eigen::Index>& poses);

// At most so many poses, evenly from the whole run.
LinkageRun AtMost(const LinkageRun& run, Eigen::Index most);

// The poses of both, parts of one run.
LinkageRun Joined(const LinkageRun& run, const LinkageRun& next);

// So many poses, not filled in, with the name, the mounting and the columns of `run`.
LinkageRun Blank(const LinkageRun& run, Eigen::Index poses);

}  // namespace abbe::simulation
