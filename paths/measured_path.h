// Where an instrument saw the tool go, beside where it was sent: what every path test starts from.
//
//   const MeasuredPath path = LinkagePath(recording, chain, rows, p_MT);
//   const MeasuredPath reference = ReferencePath(recording);
//
// Frames: axis coordinates [x y z], as the columns x_mm y_mm z_mm have them: an error is measured -
// commanded along each axis. The linkage gives p_MT in the machine frame as the workpiece carries
// it (relm/linkage_settings.h); an axis that carries the workpiece counts the other way there, and
// is turned here. Units: m, s, m/s. Shapes: one column or entry a pose. Rows with a flag are left
// out.
// Failure: InputError with the recording's name for a missing column, a row without a flag that
// holds no number, or no row at all.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "machine/chain.h"
#include "recording/recording.h"

namespace abbe::paths {

struct MeasuredPath {
  std::string recording;
  std::string instrument;         // "linkage", "reference"
  std::string plane;              // of the header, may be empty
  double radius = 0.0;            // m: the programmed radius of a circle by the header; 0: not said
  std::vector<std::size_t> rows;  // of the recording
  std::size_t flagged = 0;        // rows left out
  std::array<bool, 3> seen{};     // the coordinates that the instrument has; others are commanded
  Eigen::Matrix3Xd commanded, measured;
  Eigen::VectorXd time;       // row numbers where the recording has no time
  Eigen::VectorXd feed;       // 0: not stated
  Eigen::VectorXi pass;       // 1 where not stated
  Eigen::VectorXi direction;  // of the column; 2 where there is none

  Eigen::Index poses() const { return commanded.cols(); }
};

constexpr int kNoDirection = 2;

// `p_MT` belongs to the rows `rows`, as relm::ReadAngles gives them.
MeasuredPath LinkagePath(const recording::Recording& recording, const machine::Chain& chain,
                         const std::vector<std::size_t>& rows, const Eigen::Matrix3Xd& p_MT);

MeasuredPath ReferencePath(const recording::Recording& recording);

// Whether the recording has positions of a reference instrument.
bool HasReference(const recording::Recording& recording);

// The columns of `path` with these indices, in that order.
MeasuredPath Selection(const MeasuredPath& path, const std::vector<Eigen::Index>& poses);

}  // namespace abbe::paths
