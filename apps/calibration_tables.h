// The result of `abbe calibrate` as data and as tables for people. Data in SI unless the key has a
// unit; tables end in a newline.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "fusion/calibrate.h"
#include "fusion/model_comparison.h"
#include "fusion/pose_choice.h"
#include "fusion/volume_study.h"

namespace abbe::apps {

nlohmann::ordered_json CalibrationJson(const fusion::CalibrationReport& report,
                                       const std::vector<simulation::LinkageRun>& runs);
std::string CalibrationTable(const fusion::CalibrationReport& report,
                             const std::vector<simulation::LinkageRun>& runs);

// The number of combinations of parameters that the data determine, and the others in words.
std::string SeenTable(const fusion::Observability& seen);

nlohmann::ordered_json ComparisonJson(const std::vector<fusion::ComparedModel>& rows);
// With the published figures of Boelens (2006) for the rows that he has.
std::string ComparisonTable(const std::vector<fusion::ComparedModel>& rows);

// The uncertainty left by calibrations of different numbers of poses; `reading_noise` in m.
std::string EnoughTable(const std::vector<fusion::EnoughRow>& rows, double reading_noise);
// The uncertainty left by calibrations in different volumes.
std::string VolumeTable(const std::vector<fusion::VolumeRow>& rows);

}  // namespace abbe::apps
