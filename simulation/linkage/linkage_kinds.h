// What kinds share that are recorded with a linkage.
#pragma once

#include <string>
#include <vector>

#include "simulation/run_kind.h"

namespace abbe::simulation {

// Runs on one base and under one name of the ball are of one ball (one_ball.h).
inline constexpr const char* kOneAtATime = "give recordings of one ball at a time";
void RefuseOtherBalls(const std::vector<RunSource>& sources, const relm::LinkageSettings& linkage,
                      const std::string& advice = kOneAtATime);
// The lines of [mounting]: its base.
std::string BaseLines(const std::string& base);
std::string BaseOf(const recording::Recording& run);

// Most poses of a run in a diagnosis, which needs its time for causes.
inline constexpr Eigen::Index kMostDiagnosedPoses = 1500;

}  // namespace abbe::simulation
