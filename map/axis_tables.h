// A map as the tables of its 21 errors, which is what controls and other programs exchange.
//
//   const AxisTables tables = Tabulate(map, p_TQ, {31, 31, 31});
//   const ErrorMap back = MapOfTables(tables);
//
// Order of the tables: machine/error_motion.h. Units: SI. A table without positions is an error that
// the file does not hold: zero.
//
// The tables state the errors of the carriages, as machine/volumetric_error.h says. Axes that
// carry the workpiece and count as the tool goes (ISO 841) are for a control axes of the tool:
// where all of them do, Tabulate gives the errors of the same machine with its axes on the tool's
// side, chain and all, and every error in the file is then one of the tool against the workpiece.
// The volumetric error is the same, exactly. Failure: InputError for an axis without any table, a
// table of one position or whose positions do not increase, and for a file that does not say its
// chain or how it counts. Validity: between the positions straight lines. Tables are taken as they
// stand, constants and slopes included (Gauge::kNone, machine/error_function.h): nothing of the
// volumetric error is lost.
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

// What the exchanged tables hold an error in: mm or rad, in SI.
double TableUnit(int error);

AxisTables Tabulate(const ErrorMap& map, const Eigen::Vector3d& p_TQ,
                    const std::array<Eigen::Index, 3>& counts);

// What the numbers mean, for a person and for a reader to be built from: one line each.
std::vector<std::string> SignOfTables(const AxisTables& tables);

// Without uncertainty, sources all "prior".
ErrorMap MapOfTables(const AxisTables& tables);

}  // namespace abbe::map
