// Recordings of the linkage and of a grid encoder on the rig, made in memory: what `abbe` would
// have recorded of a programmed course.
//
//   const LinkageRig rig(World(ReadRigSettings(root), seed), Linkage(ReadLinkage(root), seed));
//   const Course course = CircleCourse({.radius = 0.01, .feed = 1e-3});
//   const recording::Recording circle = rig.Record(course, {.kind = "linkage"});
//
// Kind "linkage": the angles of the encoders; kind "reference": the place of the tool in the
// workpiece by a grid encoder of [linkage.noise] reference_um, in axis coordinates: the axis
// positions of that place on a perfect machine. x_mm, y_mm, z_mm are the positions by the
// controller. Hidden effects act here too: the machine is followed step by step (hidden_run.h). The
// same (machine file, seed, course, run) gives the same recording.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "recording/recording.h"
#include "rig/climate.h"
#include "rig/course.h"
#include "rig/hidden_run.h"
#include "rig/linkage.h"
#include "rig/world.h"

namespace abbe::rig {

struct CourseOptions {
  std::string kind = "linkage";  // or "reference"
  bool reference = false;        // the grid encoder beside the linkage, in one recording
  double rate = 100.0;           // rows in a second, at most the update rate
  double cap_force = 0.0;        // N, of the magnet in the tool cap; 0: that of the machine file
  std::uint64_t run = 1;         // runs of one world differ in their noise only
  std::string started = "1970-01-01T00:00:00Z";
  std::string keys = {}, tables = {};     // further lines of TOML, in front of the tables, behind
  std::vector<std::string> sensors = {};  // temperature columns beside the linkage's
  double step = 0.0;                      // s, in which the machine is followed; 0: an update
  double begin = 0.0;                     // s since the machine was switched on
  Climate* climate = nullptr;             // of a campaign; none: its own, and `begin` is 0
};

class LinkageRig {
 public:
  LinkageRig(World world, Linkage linkage);

  const World& world() const { return world_; }
  const Linkage& linkage() const { return linkage_; }

  // The place of the tool in the workpiece, as the table carries it: without error the machine's
  // origin with all axes at zero.
  Eigen::Vector3d ToolAt(const Eigen::Vector3d& position) const;
  // The same place in axis coordinates.
  Eigen::Vector3d ReferenceAt(const Eigen::Vector3d& position) const;
  // Ball minus cap while the axes move, by the friction of [rig] cap_um.
  Eigen::Vector3d TrailingAt(const Eigen::Vector3d& velocity, double cap_force) const;
  // How the ball sits in the spindle in one run, in M.
  Eigen::Vector3d SeatIn(std::uint64_t run) const;
  // Angles without noise and not rounded to counts; `hidden` has followed the axes to `state`.
  // `seat`: displacement of the ball in its cap, in M.
  Eigen::Vector3d EncodersAt(const CourseState& state, double temperature, double cap_force,
                             HiddenRun& hidden,
                             const Eigen::Vector3d& seat = Eigen::Vector3d::Zero()) const;
  // The same without hidden effects.
  Eigen::Vector3d EncodersAt(const CourseState& state, double temperature, double cap_force) const;

  // For a step without a row: moves ball and pivots on, after `hidden` has followed the axes.
  void Follow(const CourseState& state, double temperature, double cap_force,
              HiddenRun& hidden) const;
  // The displacement of the ball by a hidden friction in its cap, in the workpiece.
  Eigen::Vector3d BallFrom(HiddenRun& hidden) const;

  // InputError for an unknown kind, a bad rate, or a place out of the linkage's reach.
  recording::Recording Record(const Course& course, const CourseOptions& options = {}) const;

  // The drawn values of the linkage.
  nlohmann::ordered_json Truth() const;

 private:
  World world_;
  Linkage linkage_;
};

}  // namespace abbe::rig
