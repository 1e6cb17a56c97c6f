// The volumetric error of many points at once, compiled for each width of the processor's vectors:
// the motions of the axes, then the chain of the carriages.
//
// Frames: volumetric_error.h.
// Units: m, rad. Shapes: blocks of MotionBlock::kBlock points; what lies beyond the points in use is
// computed too and means nothing.
// Failure: none; a value that is not finite passes through.
// Source: volumetric_error.h and volumetric_jacobian.h.
// Validity: turns below kLargestTurn, whose rotation is a series.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "machine/axis_motions.h"

namespace abbe::machine {

// The series neglect a^8 / 9! < 3e-22.
inline constexpr double kLargestTurn = 1e-2;  // rad

// One carriage of the chain.
struct Carriage {
  int axis;
  double sense;                       // CarriageSense
  Eigen::Vector3d line;               // l, in M
  Eigen::Matrix3d J_line_squareness;  // dl / d[A0Z B0Z C0Y]
};

struct Carriages {
  std::array<Carriage, kAxes> work, tool;  // each from the bed
  int work_count = 0, tool_count = 0;
  std::array<double, kAxes> tool_senses = {};
};

struct PointBlock {
  alignas(64) double positions[kAxes][MotionBlock::kBlock] = {};
  std::array<MotionBlock, kAxes> motions, slopes;  // the slopes only for derivatives
};

// What is computed at a point with all derivatives: the error and matrices of three rows by columns.
enum DerivativeRow {
  kOfError = 0,
  kByMotions = 3,
  kBySquareness = 57,
  kByPosition = 66,
  kByTool = 75,
  kRows = 84
};

// f = c0 + t (c1 + t (c2 + ...)) of all motions at each place, and df/dx unless `slopes` is null.
void EvaluatePieces(std::span<const PlaceInPiece> places, int degree, MotionBlock& values,
                    MotionBlock* slopes);
// The errors of `count` points in columns. Returns the square of the largest turn of the block.
double BlockErrors(const Carriages& carriages, const Eigen::Vector3d& p_TQ,
                   const PointBlock& points, int count, double* errors);
// With all derivatives, kRows numbers for each point.
double BlockDerivatives(const Carriages& carriages, const Eigen::Vector3d& p_TQ,
                        const PointBlock& points, int count, double* rows);

}  // namespace abbe::machine
