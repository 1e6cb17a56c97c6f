// The header of an exported file: comment lines "key = value" behind the comment mark of the
// format.
//
//   # machine = demo-mill
//   # chain = [w X Y b Z t]
//   # positive = carriage carriage tool
//   # tool_mm = 0 0 -80
//   # temperature_c = 20
//   # scale = prior only
//   # sign = what the numbers mean, in the words of each format
//
// Frames: p_TQ as error_map.h.
// Units: SI inside, in the file those of the key.
// Failure: InputError for an invalid chain or number. Lines without a known key are ordinary
// comments and are ignored.
// Source: own; every format has comments, so the header survives where the format has no place for
// it.
// Validity: an importer trusts it; without `chain` or `positive` the command line has to state
// them.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "map/error_map.h"

namespace abbe::map {

struct FileHeader {
  std::string machine;
  std::string chain;     // empty: not stated
  std::string positive;  // sign of X, Y, Z (machine/chain.h); empty: not stated
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();  // p_TQ, m
  double temperature = 20.0;                       // degC
  std::string scale = "prior only";

  friend bool operator==(const FileHeader&, const FileHeader&) = default;
};

// The header of a map exported for the tool p_TQ.
FileHeader HeaderOf(const ErrorMap& map, const Eigen::Vector3d& p_TQ);
// The comment lines of the header; `sign`: the lines "sign = ...".
std::string HeaderText(const FileHeader& header, std::string_view mark,
                       const std::vector<std::string>& sign);

// The chain with the sign of its positions. InputError if the header lacks either.
machine::Chain ChainOf(const FileHeader& header);

// `sign` of the formats that hold the error at points.
inline constexpr const char* kSignOfPoints =
    "actual - nominal of the tool in the workpiece, at positions as the control counts";

// Reads one comment, without its mark, into the header.
void ReadComment(std::string_view comment, FileHeader& header);

}  // namespace abbe::map
