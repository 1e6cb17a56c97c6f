// A campaign: what was measured on one machine in one go, read from the files that it left.
//
//   const Campaign campaign = ReadCampaign({"measured/"}, {});
//   for (const std::string& note : campaign.notes) fmt::print("{}\n", note);
//
// From a folder (not from folders below it), or single files, it takes the results (*.json with a
// text "command"), the recordings (*.csv, *.h5, *.hdf5) and the error maps (*.toml). Other files
// are left out; of single files that is noted. Recordings are known by path and SHA-256 and stay
// where they are. A result's instant is its `started`, else that of the recordings, else
// `measured`.
//
// Units: seconds since 1970 in UTC. Failure: InputError for a path that cannot be read, a folder
// without a result or recording, results of several machines, and a campaign of which nothing
// states the machine or the instant.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "failure/failure.h"
#include "history/figures_of_result.h"

namespace abbe::history {

struct ResultFile {
  std::string file, sha256, content;  // content: the JSON as it was
  std::string command, kind;
  double measured = 0.0;
  Extract extract;
};

struct RecordingFile {
  std::string path, sha256, kind, started;
  long long bytes = 0;
};

struct TextFile {
  std::string name, sha256, content;
};

struct Campaign {
  std::string machine, serial, name, who, note;
  double measured = 0.0;
  std::map<std::string, std::string> instruments;  // "head" -> "P-12"
  std::optional<TextFile> machine_file;
  std::vector<ResultFile> results;
  std::vector<RecordingFile> recordings;
  std::vector<TextFile> maps;
  std::vector<std::string> notes;  // what the user has to know

  std::string Sha256() const;  // of the hashes of its files, in any order
};

struct CampaignOptions {
  std::filesystem::path machine;  // machine file; empty: the machine is that of the results
  std::string who, note;
  std::map<std::string, std::string> instruments;
  std::optional<double> measured;
  double now = 0.0;  // a later measurement is noted; 0: not checked
};

Campaign ReadCampaign(const std::vector<std::filesystem::path>& from,
                      const CampaignOptions& options);

}  // namespace abbe::history
