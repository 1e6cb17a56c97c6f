// Import of the tables of laser interferometers (.rtl: linear positioning by Renishaw's programs
// and others that write its form) into a recording of kind "reference" with one axis.
//
//   HEADER::
//   File type  : rtl
//   TARGET DATA::
//   Target-count: 3
//   Targets :
//   0.000  100.000  200.000          mm, on as many lines as they take
//   Flags: 0 0 2 0                   the second: 0 both directions, 1 one
//   USER-TEXT::
//   Axis:X
//   RUNS::
//   Run-count:2
//   DEVIATIONS::
//   Run Target Data:
//   1   1      0.3                   run, target, deviation of the reading from the target in um
//   EOF::
//
// Runs with odd numbers go along the list of targets, those with even numbers back; two are a
// cycle. A deviation is reading - target. Other sections (environment, equipment) are not used.
// Units: mm and um, recording as target_test.h has it. Failure: InputError with file and line for
// what has another form, counts that do not agree, readings given twice, an even run listed as if
// it went along the targets where the flags do not say that it goes back, another axis than asked,
// and a file without EOF:: (truncated).
// Source: four programs of others in public that read or write such files, the maker documents
// none. Validity: linear positioning in both directions.
#pragma once

#include <filesystem>
#include <string>

#include "recording/recording.h"

namespace abbe::recording {

// `axis` is X, Y, Z, or empty for the one that the file states.
Recording ReadLaserTable(const std::filesystem::path& path, const std::string& axis);

}  // namespace abbe::recording
