// For `abbe circle` and `abbe path`: paths in axis coordinates from recordings of the linkage or of
// a reference, one list per instrument.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/causes_option.h"
#include "machine/machine.h"
#include "paths/measured_path.h"

namespace abbe::apps {

struct PathSources {
  std::vector<std::filesystem::path> recordings;
  std::filesystem::path machine, calibration;
  CausesOption causes;
};

// The arguments of both commands.
void AddPathSources(CLI::App& command, PathSources& sources);

struct MeasuredPaths {
  std::vector<paths::MeasuredPath> linkage, reference;
  // The displacement of the paths of the linkage by each independent error of the calibration, as
  // large as its standard deviation: [error][path], 3 x poses, m. The last one, where an extended
  // model is not sure of all its causes: the change by those (simulation/doubt.h).
  std::vector<std::vector<Eigen::Matrix3Xd>> errors;
  double unexplained = 0.0;                 // m rms, beside such a model
  std::optional<machine::Machine> machine;  // of the machine file
  // The head of a result, without its command.
  nlohmann::ordered_json head = nlohmann::ordered_json::object();
  std::vector<std::string> notes;

  // The paths of the linkage, then those of the reference.
  std::vector<paths::MeasuredPath> All() const;
  // The same with one error of the calibration added.
  std::vector<paths::MeasuredPath> WithError(std::size_t error) const;
};

// A recording with encoder angles gives a path of the linkage, one with reference positions a path
// of the reference, one with both gives both, radii of a ballbar a path too. Warnings of a file go
// to standard error. InputError for a recording with none of these, a linkage without --machine, a
// calibration without a linkage, or a machine file of another machine.
MeasuredPaths ReadMeasuredPaths(const PathSources& sources);

// The head of the results of both commands.
nlohmann::ordered_json ResultHead(const std::string& command, const MeasuredPaths& paths);

}  // namespace abbe::apps
