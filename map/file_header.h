// What a file of numbers says of itself in comments: lines "key = value" behind the comment mark
// of its format.
//
//   # machine = demo-mill
//   # chain = [w X Y b Z t]
//   # positive = carriage carriage tool
//   # tool_mm = 0 0 -80
//   # temperature_c = 20
//   # scale = prior only
//   # sign = what the numbers mean, in the words of each format
//
// Units: SI inside, the key's in the file. Failure: InputError from a chain or number that is none.
// Lines without a known key are other people's comments and are passed over.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "map/error_map.h"

namespace abbe::map {

struct FileHeader {
  std::string machine;
  std::string chain;                               // empty: the file does not say
  std::string positive;                            // how X, Y, Z count; empty: it does not say
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();  // p_TQ, m
  double temperature = 20.0;                       // degC
  std::string scale = "prior only";

  friend bool operator==(const FileHeader&, const FileHeader&) = default;
};

FileHeader HeaderOf(const ErrorMap& map, const Eigen::Vector3d& p_TQ);
// `sign`: one line each.
std::string HeaderText(const FileHeader& header, std::string_view mark,
                       const std::vector<std::string>& sign);

// The chain with its count. InputError for a file that does not say it.
machine::Chain ChainOf(const FileHeader& header);

// Of the formats that hold the error at points.
inline constexpr const char* kSignOfPoints =
    "actual - nominal of the tool in the workpiece, at positions as the control counts";

// Takes in the text of one comment, without its mark.
void ReadComment(std::string_view comment, FileHeader& header);

}  // namespace abbe::map
