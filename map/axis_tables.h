// A map as tables of its 21 errors, the form that controls and other programs exchange.
//
//   const AxisTables tables = Tabulate(map, p_TQ, {31, 31, 31});
//   const ErrorMap back = MapOfTables(tables);
//
// Order of the tables: machine/error_motion.h. Units: SI. A table without positions is an error
// that the file does not contain: zero.
//
// The tables hold the errors of the carriages (machine/volumetric_error.h) of the chain in the
// header. A control treats axes that carry the workpiece and count as the tool goes (ISO 841) as
// axes of the tool. If all of them do, Tabulate converts the map to the equivalent chain with all
// axes on the tool side, and every error in the file is one of the tool relative to the workpiece.
// The volumetric error is exactly the same.
// Frames: as machine/volumetric_error.h. Shapes: positions and values of equal length; the errors
// in the order of machine/error_motion.h.
// Failure: InputError for an axis without any table, for a table of one position or with positions
// that do not increase, and for a file without its chain or the sign of its positions.
// Source: own; the equivalent chain turns every carriage into one that carries the tool.
// Validity: linear interpolation between the positions. Tables are not changed: constants and
// slopes stay (Gauge::kNone, machine/error_function.h), so the volumetric error is complete.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "map/error_map.h"
#include "map/file_header.h"

namespace abbe::map {

struct ErrorTable {
  std::vector<double> positions;  // m
  std::vector<double> values;     // m or rad
};

struct AxisTables {
  FileHeader header;
  std::array<ErrorTable, machine::kAxes * machine::kMotions> errors;
  Eigen::Vector3d squareness = Eigen::Vector3d::Zero();  // A0Z B0Z C0Y, rad
};

// The unit of an error in the exchanged tables, mm or rad, in SI.
double TableUnit(int error);

// `counts`: positions along X, Y and Z, at least 2 each.
AxisTables Tabulate(const ErrorMap& map, const Eigen::Vector3d& p_TQ,
                    const std::array<Eigen::Index, 3>& counts);

// The sign conventions of the file, one line each, for its header.
std::vector<std::string> SignOfTables(const AxisTables& tables);

// The map of the tables, without uncertainty; all sources are "prior".
ErrorMap MapOfTables(const AxisTables& tables);

}  // namespace abbe::map
