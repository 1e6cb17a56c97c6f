// How the commands that use a map are told which, and for what tool.
#pragma once

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "map/error_map.h"

namespace abbe::apps {

struct MapOption {
  std::filesystem::path path;
  std::string chain, positive;
  std::vector<double> tool_mm;  // empty: the tool of the measurement

  void AddTo(CLI::App& command);
  // Prints that the scale is the prior's where it is, on standard error.
  map::ErrorMap Read() const;
  // p_TQ, m.
  Eigen::Vector3d Tool(const map::ErrorMap& map) const;
};

// "--points 31" or "--points 31,11,21": of X, Y, Z.
std::array<Eigen::Index, 3> PointsOf(const std::vector<int>& given);

// Three lengths in mm as an option gives them, in m.
Eigen::Vector3d VectorOf(const std::vector<double>& mm);

}  // namespace abbe::apps
