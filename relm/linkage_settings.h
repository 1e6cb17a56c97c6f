// The linkage as the machine file describes it, and the error models made from that.
//
//   const auto document = settings::Document::Read("machine.toml");
//   const LinkageSettings linkage = ReadLinkageSettings(document.Root());
//   const LinkageModel model = MakeLinkageModel(linkage, ErrorModel::kPublishedWithBearing);
//
// Frames: B, the linkage base; M, the machine frame as the workpiece carries it: the ball of a
// perfect machine stands at p_MT = (sx x, sy y, sz z) for the axis positions (x, y, z), s = -1 for
// an axis that carries the workpiece, +1 for one that carries the tool.
// Units: SI. Shapes: joints, rows, segments and axes from the base to the ball.
// Failure: InputError with file, line and key, also for an unknown key in [linkage].
// docs/machine-file.md lists every key.
// Source: docs/theory-linkage.md.
// Validity: a prior is normal with the stated deviation; masses are exact.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "geometry/transform.h"
#include "machine/chain.h"
#include "relm/error_model_name.h"
#include "relm/linkage_model.h"
#include "relm/pivot_linkage.h"
#include "relm/serial_chain.h"
#include "settings/document.h"

namespace abbe::relm {

// Standard deviations that remain after manufacture and mounting: the priors of the parameters.
struct LinkageTolerance {
  double link;            // m: length of a link
  double pivot_angle;     // rad: tilt or twist of a pivot's axis
  double pivot_offset;    // m: offset of a pivot's axis
  double encoder_offset;  // rad
  double eccentricity;    // rad: amplitude once per turn
  double graduation;      // rad: amplitude of each harmonic
  double bearing;         // m: amplitude of each harmonic of the run-out
  double base_position;   // m: of the base in the machine, each direction
  double base_angle;      // rad: about each axis
  double ball;            // m: of the ball's centre across the last link
  double compliance;      // rad: deflection of a pivot under a horizontal link
  double thermal;         // 1/K: of the coefficient of expansion
  double seat = 0.0;      // m: of the ball in the spindle, each direction, anew for each run
  double weight = 0.0;  // rad/m: turn of a pivot under a weight, over its lever; 0: no such errors
};

struct LinkageNoise {
  double encoder;        // rad: standard deviation of one reading
  double reference;      // m: of a position that a reference instrument gives, each direction
  double machine;        // m: of a commanded position where it is the reference, each direction
  double repeatability;  // m: of the ball when a position is approached again, each direction
  std::vector<double> measured = {};  // rad: like `encoder`, of each joint where recordings tell; 0
  // The share of an encoder's variance that goes on from reading to reading, and for how long, s.
  double memory_share = 0.0, memory_time = 0.0;

  // rad, one reading: as measured, else as stated.
  double EncoderOf(std::size_t joint) const {
    return joint < measured.size() && measured[joint] > 0.0 ? measured[joint] : encoder;
  }
};

// A part of the arm, or its load, whose weight is known.
struct Mass {
  double kg;
  Eigen::Index carrier;   // the last joint that moves it, from 0
  Eigen::Vector3d point;  // m, in B at zero angles: its centre
};

struct LinkageSettings {
  SerialChain chain;
  std::vector<DenavitHartenbergRow> rows;  // form "denavit-hartenberg", ball_mm in the last frame
  Eigen::Vector3d p_nT = {0.0, 0.0, 0.0};  // m: that ball
  std::vector<Mass> masses;                // empty: weights are not known
  std::optional<PivotLinkage> pivots;      // form "pivots": the closed form of the same chain
  Branch branch;                           // of the workspace; form "pivots" only
  std::vector<Segment> segments;           // forms "pivots" and "segments"
  geometry::Transform<double> X_MB;        // nominal
  Eigen::Vector3d down_M;                  // the direction of gravity
  double expansion;                        // 1/K: nominal coefficient of the links
  double reference_temperature;            // degC
  std::string temperature;                 // column of a recording; empty: none
  std::vector<int> bearing_harmonics;
  std::vector<int> graduation_harmonics;
  LinkageTolerance tolerance;
  LinkageNoise noise;

  // The direction of gravity in B.
  Eigen::Vector3d DownB() const { return X_MB.R.transpose() * down_M; }
};

// [linkage] and its sub-tables.
LinkageSettings ReadLinkageSettings(const settings::Table& root);

// p_MT, m: the ball of a perfect machine.
Eigen::Vector3d NominalTip(const machine::Chain& chain, const Eigen::Vector3d& axis_positions);

// The parameters of each model: error_models.h. InputError when `settings` lack what it needs.
LinkageModel MakeLinkageModel(const LinkageSettings& settings, ErrorModel model);

}  // namespace abbe::relm
