// Formats of the tables of the 21 errors: ISG and Etalon.
//
// ISG (Beckhoff TF5280, ISG kernel) CSV: blocks of blank-separated columns, first the names; `#`
// starts the next block, `//` a comment. Position in mm, errors in mm and rad.
//
//   X EXX EYX EZX EAX EBX ECX
//   0 0 0 0 0 0 0
//   2 0.00031 ...
//   #
//   C0Y B0Z A0Z
//   1.2e-05 -3e-06 8e-06
//
// Etalon exchange: one section per error, `//` a comment; mm and rad.
//
//   [EXX]
//   Gridpoints = {
//   0 0
//   2 0.00031
//   }
//   [C0Y]
//   VALUE = 1.2e-05
//
// Failure: InputError with file and line. A name that is not one of the 21 errors is refused, as is
// an error that depends on two axes, which the machine model does not contain.
// Source: the public descriptions of both formats in the TF5280 manual; own words and own code.
#pragma once

#include "map/exporter.h"

namespace abbe::map {

// For each format: a writer that returns the files written, a reader of the tables, and the error
// of the tables for the exporter's comparison.
Format::Paths WriteIsg(const ErrorMap& map, const ExportOptions& options,
                       const std::filesystem::path& path);
AxisTables ReadIsg(const std::filesystem::path& file);
ErrorField ReadBackIsg(const Format::Paths& files, const machine::Chain& chain);

Format::Paths WriteEtalon(const ErrorMap& map, const ExportOptions& options,
                          const std::filesystem::path& path);
AxisTables ReadEtalon(const std::filesystem::path& file);
ErrorField ReadBackEtalon(const Format::Paths& files, const machine::Chain& chain);

// The volumetric error of the tables, for the tool in their header.
ErrorField FieldOf(const AxisTables& tables);

}  // namespace abbe::map
