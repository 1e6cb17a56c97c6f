// The options of the commands that use a map: the map and the tool.
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
  // Warns on standard error if the scale of the map is that of the prior.
  map::ErrorMap Read() const;
  // p_TQ, m.
  Eigen::Vector3d Tool(const map::ErrorMap& map) const;
};

// "--points 31" or "--points 31,11,21": points along X, Y, Z. InputError for another number of
// numbers, fewer than 2 points or too many: of a grid all its points count, else those along the
// axes.
std::array<Eigen::Index, 3> PointsOf(const std::vector<int>& given, bool is_grid);

// Three lengths in mm from an option, in m. InputError with the option for what is not finite.
Eigen::Vector3d VectorOf(const std::string& option, const std::vector<double>& mm);

}  // namespace abbe::apps
