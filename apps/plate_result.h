// The result of `abbe plate` as data and as tables for people. Data in SI unless the
// key has a unit; tables end in a newline.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "fusion/fuse.h"
#include "fusion/interpolators.h"
#include "fusion/plate_diagonals.h"
#include "fusion/specimen_check.h"
#include "fusion/wrong_holes.h"

namespace abbe::apps {

struct PlateResult {
  fusion::FuseReport fused;
  std::array<fusion::DiagonalSquareness, 3> diagonals;
  std::vector<fusion::InterpolatorCheck> interpolators;  // empty: nothing was held out
  std::vector<fusion::SpecimenLength> specimen;          // empty: none given
  std::vector<fusion::WrongHole> wrong_holes;            // left out
};

// The keys of `abbe fuse`, and those of docs/plate.md.
nlohmann::ordered_json PlateJson(const PlateResult& result);
std::string PlateTable(const PlateResult& result);

}  // namespace abbe::apps
