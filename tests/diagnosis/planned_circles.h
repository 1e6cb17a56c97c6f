// Circles of a linkage as paths, for what can be said of them in closed form.
#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "../folders.h"
#include "diagnosis/campaign.h"
#include "recording/recording.h"
#include "settings/document.h"

namespace abbe::diagnosis {

inline simulation::Instruments DemoInstruments() {
  const auto document = settings::Document::Read(DemoMillFile());
  const auto& root = document.Root();
  return {machine::ReadMachine(root), probes::ReadHeadSettings(root),
          probes::ReadTargetSettings(root), probes::ReadProbeNoise(root),
          relm::ReadLinkageSettings(root)};
}

// In XY around the middle of the demonstration machine, 20 mm, round and back, 1 degree a row.
inline recording::Recording CircleAt(double feed_mm_min) {
  recording::Recording circle;
  circle.name = "circle";
  circle.header = "kind = \"linkage\"\n";
  for (const char* name : {"time_s", "x_mm", "y_mm", "z_mm", "pass", "direction"}) {
    circle.columns.push_back({name, {}});
  }
  const double turn = 2.0 * std::numbers::pi * 20.0 / (feed_mm_min / 60.0);
  for (const int sense : {1, -1}) {
    for (int degree = 0; degree < 360; ++degree) {
      const double angle = sense * degree * std::numbers::pi / 180.0;
      const std::vector<double> row{(sense > 0 ? 0.0 : turn + 5.0) + turn * degree / 360.0,
                                    30.0 + 20.0 * std::cos(angle),
                                    30.0 + 20.0 * std::sin(angle),
                                    30.0,
                                    sense > 0 ? 1.0 : 2.0,
                                    static_cast<double>(sense)};
      for (std::size_t i = 0; i < row.size(); ++i) circle.columns[i].values.push_back(row[i]);
    }
  }
  return circle;
}

}  // namespace abbe::diagnosis
