// The result of `abbe track` as data and as tables for people. Data in SI unless the key has a
// unit; tables end in a newline.
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "map/error_map.h"
#include "recording/recording.h"
#include "track/outlook.h"
#include "track/tracked_map.h"

namespace abbe::apps {

struct TestReport {
  std::string name, kind;
  double began = 0.0, minutes = 0.0;
  double noise = 1.0;                // over the stated one
  track::Agreement agreement = {};   // no directions: a recording of temperatures
  double before = 0.0, after = 0.0;  // m: largest U95 over the volume
};

struct LearnedReport {
  double factor = 1.0, gain = 0.0;
  machine::Population walk;
  std::vector<map::Warmth> sensors;
};

struct TrackReport {
  std::vector<TestReport> tests;
  std::optional<LearnedReport> learned;
  std::vector<track::Watched> watched;
  std::optional<track::Choice> choice;
  double days = 0.0;  // of the choice
  std::optional<Eigen::Vector3d> at;
  std::filesystem::path out;
};

// From the first to the last row.
double MinutesOf(const recording::Recording& recording);
// The largest U95 among the corners and the middle of the volume, m.
double LargestU95(const map::ErrorMap& map);

nlohmann::ordered_json TrackJson(const map::ErrorMap& map, const TrackReport& report);
std::string TrackText(const map::ErrorMap& map, const TrackReport& report);

}  // namespace abbe::apps
