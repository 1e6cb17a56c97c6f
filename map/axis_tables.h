// A map as the tables of its 21 errors, which is what controls and other programs exchange.
//
//   const AxisTables tables = Tabulate(map, p_TQ, {31, 31, 31});
//   const ImportedMap back = MapOfTables(tables);
//
// Order of the tables: error_motion.h. Units: SI. A table without positions is an error that the
// file does not hold: zero.
// Failure: InputError for an axis without any table, a table of one position or whose positions do
// not increase, and for a file that does not say its chain.
// Validity: between the positions straight lines. A foreign table may break our gauge
// (error_function.h). The slope of a straightness then goes into the squareness, which changes the
// map by a turn of the whole workpiece only; a value at the start of the travel is taken off.
// Both are told in `notes`.
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

struct ImportedMap {
  ErrorMap map;                    // without uncertainty, sources all "prior"
  std::vector<std::string> notes;  // for a person, one line each
};

ImportedMap MapOfTables(const AxisTables& tables);

}  // namespace abbe::map
