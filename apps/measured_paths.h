// `abbe circle` and `abbe path`: recordings of the linkage or of a reference become paths in axis
// coordinates, one list an instrument.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "relm/measured_path.h"

namespace abbe::apps {

struct PathSources {
  std::vector<std::filesystem::path> recordings;
  std::filesystem::path machine;
};

// The arguments that both commands take.
void AddPathSources(CLI::App& command, PathSources& sources);

struct MeasuredPaths {
  std::vector<relm::MeasuredPath> linkage, reference;
  std::string machine, chain, started;  // of the machine file and the first recording
  std::vector<std::string> notes;

  // Those of the linkage, then those of the reference.
  std::vector<relm::MeasuredPath> All() const;
};

// A recording with encoder angles gives a path of the linkage, one with reference positions a path
// of the reference, one with both gives both. Warnings of a file go to standard error. InputError
// for a recording with neither, a linkage without --machine, or a machine file of another machine.
MeasuredPaths ReadMeasuredPaths(const PathSources& sources);

// What results of both commands begin with.
nlohmann::ordered_json ResultHead(const std::string& command, const MeasuredPaths& paths);

}  // namespace abbe::apps
