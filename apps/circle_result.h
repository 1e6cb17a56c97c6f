// The result of `abbe circle` as data and as a table. docs/circle.md lists the keys of the data.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/circle_figures.h"
#include "fusion/circle_causes.h"
#include "paths/circle_run.h"

namespace abbe::apps {

// All runs of one instrument, plane and radius, one feed each, and their causes by one joint fit.
struct Circle {
  std::vector<paths::CircleRun> runs;
  // One for each run:
  std::vector<paths::CircleFigures> figures;
  std::vector<FigureUncertainties> uncertainties;
  std::optional<fusion::CircleCauses> causes;
  double cutoff = 0.0;  // of the filter, undulations per turn; 0: none
};

nlohmann::ordered_json CircleJson(const Circle& circle);

// The figures of all runs side by side, then the causes of each circle; ends in a newline.
std::string CircleTable(const std::vector<Circle>& circles);

}  // namespace abbe::apps
