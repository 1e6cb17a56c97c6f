// A measured path with the commanded one: the input of every path test.
//
//   const MeasuredPath path = LinkagePath(recording, chain, rows, p_MT);
//   const MeasuredPath reference = ReferencePath(recording);
//   const MeasuredPath ballbar = BallbarPath(recording);
//
// Frames: axis coordinates [x y z], as the columns x_mm y_mm z_mm have them: an error is measured -
// commanded along each axis. The linkage gives p_MT in the machine frame as the workpiece carries
// it (relm/linkage_settings.h); LinkagePath reverses the axes that carry the workpiece. Units: m,
// s, m/s. Shapes: one column or entry a pose. Rows with a flag are left out.
// Failure: InputError with the recording's name for a missing column, a row without a flag that
// has no number, or no row at all.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "machine/chain.h"
#include "recording/recording.h"

namespace abbe::paths {

inline constexpr const char* kByLinkage = "linkage";
inline constexpr const char* kByBallbar = "ballbar";

struct MeasuredPath {
  static constexpr int kDirectionNotStated = 2;  // the column has -1, 0 and 1

  std::string recording;
  std::string instrument;          // kByLinkage, kByBallbar, "reference"
  std::string plane;               // of the header, may be empty
  double radius = 0.0;             // m: programmed radius of a circle, of the header; 0: not stated
  std::optional<double> u_length;  // m: of the calibrated length of a ballbar; none: not calibrated
  std::vector<std::size_t> rows;   // of the recording
  std::size_t flagged = 0;         // rows left out
  std::array<bool, 3> seen{};      // coordinates that were measured; the others are commanded ones
  Eigen::Matrix3Xd commanded, measured;
  Eigen::VectorXd time;       // row numbers where the recording has no time
  Eigen::VectorXd feed;       // 0: not stated
  Eigen::VectorXi pass;       // 1 where not stated
  Eigen::VectorXi direction;  // -1, 0, 1; kDirectionNotStated without the column

  Eigen::Index poses() const { return commanded.cols(); }
};

// `p_MT` are the positions at the rows `rows`, as relm::ReadAngles gives them.
MeasuredPath LinkagePath(const recording::Recording& recording, const machine::Chain& chain,
                         const std::vector<std::size_t>& rows, const Eigen::Matrix3Xd& p_MT);

MeasuredPath ReferencePath(const recording::Recording& recording);

// A ballbar knows the distance from its fixed ball, here taken at 0 of the positions: the measured
// point lies in the commanded direction. What moves along the circle is not seen.
MeasuredPath BallbarPath(const recording::Recording& recording);

// Whether the recording has radii of a ballbar.
bool HasRadius(const recording::Recording& recording);

// Whether the recording has positions of a reference instrument.
bool HasReference(const recording::Recording& recording);

// The columns of `path` with these indices, in that order.
MeasuredPath Selection(const MeasuredPath& path, const std::vector<Eigen::Index>& poses);

}  // namespace abbe::paths
