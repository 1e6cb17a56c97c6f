#include "history/campaign.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <system_error>

#include "failure/failure.h"
#include "recording/file_hash.h"
#include "recording/instant.h"
#include "recording/recording_file.h"
#include "recording/started.h"
#include "settings/document.h"

namespace abbe::history {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr double kSlack = 86400.0;  // of clocks and time zones, s

std::string ContentOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf())) {
    throw InputError(
        fmt::format("{}: cannot be read: {}; check the path", path.string(), std::strerror(errno)));
  }
  return text.str();
}

std::vector<fs::path> FilesOf(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code gone;
    if (entry->is_regular_file(gone)) files.push_back(entry->path());
  }
  if (error) {
    throw InputError(fmt::format("{}: cannot be read as a folder ({}); check the path",
                                 folder.string(), error.message()));
  }
  std::ranges::sort(files);
  return files;
}

std::string NameOf(const fs::path& path) {
  const fs::path whole = fs::absolute(path).lexically_normal();
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

bool IsMap(const std::string& text) {
  return text.starts_with("# An error map:") || text.find("\n[[error]]") != std::string::npos;
}

// A discarded value when it is not JSON, or is nested deeper than any result: writing it again is
// recursive.
ordered_json JsonOf(const std::string& content) {
  constexpr int kDeepest = 100;
  bool too_deep = false;
  const auto keep = [&](int depth, ordered_json::parse_event_t, ordered_json&) {
    too_deep = too_deep || depth > kDeepest;
    return !too_deep;
  };
  ordered_json json = ordered_json::parse(content, keep, /*allow_exceptions=*/false);
  return too_deep ? ordered_json(ordered_json::value_t::discarded) : json;
}

std::string TextOf(const ordered_json& object, const char* key) {
  const auto at = object.find(key);
  return at != object.end() && at->is_string() ? at->get<std::string>() : "";
}

// A name, or a table [mounting] with an `id` and the turn of the head.
std::string MountingOf(const recording::Recording& head) {
  const auto id = head.HeaderText("mounting.id");
  if (!id) return head.HeaderText("mounting").value_or("");
  const auto turn = head.HeaderText("mounting.head");
  return turn ? fmt::format("{}, head {}", *id, *turn) : *id;
}

// Gathers the files of a campaign and what they state of machine, instant and persons.
class Gathering {
 public:
  explicit Gathering(const CampaignOptions& options) : options_(options) {
    campaign_.who = options.who;
    campaign_.note = options.note;
    campaign_.instruments = options.instruments;
    if (!options.machine.empty()) TakeMachine();
  }

  void Take(const fs::path& path) {
    if (fs::is_directory(path)) {
      if (campaign_.name.empty()) campaign_.name = NameOf(path);
      for (const fs::path& file : FilesOf(path)) TakeFile(file, /*was_named=*/false);
    } else {
      if (campaign_.name.empty()) campaign_.name = NameOf(fs::absolute(path).parent_path());
      TakeFile(path, /*was_named=*/true);
    }
  }

  Campaign Finish(const std::vector<fs::path>& from) {
    const std::string where = from.front().string();
    if (campaign_.results.empty() && campaign_.recordings.empty() && campaign_.maps.empty()) {
      throw InputError(
          fmt::format("{}: no result, recording or error map of abbe; name a folder that a command "
                      "wrote with --out, or files",
                      where));
    }
    NameMachine(where);
    Date(where);
    if (campaign_.who.empty()) campaign_.who = fmt::format("{}", fmt::join(operators_, "; "));
    if (campaign_.serial.empty()) campaign_.serial = fmt::format("{}", fmt::join(serials_, "; "));
    if (mountings_.size() == 1) campaign_.instruments.emplace("mounting", *mountings_.begin());
    if (linkages_.size() == 1) campaign_.instruments.emplace("linkage", *linkages_.begin());
    return std::move(campaign_);
  }

 private:
  void TakeMachine() {
    const std::string content = ContentOf(options_.machine);
    const auto document = settings::Document::Parse(content, options_.machine.string());
    campaign_.machine = document.Root().Text("name");
    campaign_.serial = document.Root().Child("protocol").Text("serial", "");
    campaign_.machine_file = {options_.machine.filename().string(),
                              recording::Sha256OfText(content), content};
  }

  void TakeFile(const fs::path& path, bool was_named) {
    const std::string extension = path.extension().string();
    bool taken = false;
    if (extension == ".json") taken = TakeResult(path);
    if (extension == ".csv" || extension == ".h5" || extension == ".hdf5")
      taken = TakeRecording(path, was_named);
    if (extension == ".toml") taken = TakeMap(path);
    if (!taken && was_named) {
      throw InputError(fmt::format("{}: is no result, recording or error map of abbe; leave it out",
                                   path.string()));
    }
  }

  bool TakeResult(const fs::path& path) {
    const std::string content = ContentOf(path);
    const ordered_json json = JsonOf(content);
    if (!json.is_object() || TextOf(json, "command").empty()) return false;
    if (TextOf(json, "command") == "history") return false;  // made from a history
    ResultFile result{path.filename().string(),
                      recording::Sha256OfText(content),
                      content,
                      TextOf(json, "command"),
                      TextOf(json, "kind"),
                      0.0,
                      FiguresOf(json)};
    if (const std::string started = TextOf(json, "started"); !started.empty()) {
      const auto seconds = recording::SecondsOf(started);
      if (!seconds) {
        throw InputError(
            fmt::format("{}: started = {} is no time; reduce the recording again, with a time such "
                        "as 2026-11-21T09:00:00Z in its header",
                        path.string(), started));
      }
      result.measured = *seconds;
    }
    if (!result.extract.trouble.empty()) {
      campaign_.notes.push_back(fmt::format("{}: {}", path.string(), result.extract.trouble));
    }
    AddMachine(TextOf(json, "machine"), path);
    const auto protocol = json.find("protocol");
    if (protocol != json.end() && protocol->is_object()) {
      AddUnlessEmpty(operators_, TextOf(*protocol, "operator"));
      AddUnlessEmpty(serials_, TextOf(*protocol, "serial"));
    }
    AddUnlessEmpty(mountings_, TextOf(json, "mounting"));
    const auto linkage = json.find("linkage");
    if (linkage != json.end() && linkage->is_object()) {
      AddUnlessEmpty(linkages_, TextOf(*linkage, "file"));
    }
    campaign_.results.push_back(std::move(result));
    return true;
  }

  bool TakeRecording(const fs::path& path, bool was_named) {
    recording::Recording head;
    try {
      head = recording::ReadHead(path);
    } catch (const InputError& error) {
      if (path.extension() == ".csv") return false;  // another table
      if (was_named) throw;
      campaign_.notes.push_back(fmt::format("left out: {}", error.what()));
      return false;
    }
    const std::string started = recording::StartedText(head);
    campaign_.recordings.push_back({fs::absolute(path).lexically_normal().string(),
                                    recording::Sha256OfFile(path), head.Kind(), started,
                                    static_cast<long long>(fs::file_size(path))});
    AddMachine(head.HeaderText("machine").value_or(""), path);
    AddUnlessEmpty(operators_, head.HeaderText("protocol.operator").value_or(""));
    AddUnlessEmpty(serials_, head.HeaderText("protocol.serial").value_or(""));
    AddUnlessEmpty(mountings_, MountingOf(head));
    return true;
  }

  bool TakeMap(const fs::path& path) {
    std::string content = ContentOf(path);
    if (!IsMap(content)) return false;
    std::string hash = recording::Sha256OfText(content);
    campaign_.maps.push_back({path.filename().string(), std::move(hash), std::move(content)});
    return true;
  }

  void AddMachine(const std::string& name, const fs::path& path) {
    if (!name.empty()) machines_.emplace(name, path.string());
  }
  static void AddUnlessEmpty(std::set<std::string>& texts, const std::string& text) {
    if (!text.empty()) texts.insert(text);
  }

  void NameMachine(const std::string& where) {
    for (const auto& [name, file] : machines_) {
      if (campaign_.machine.empty()) campaign_.machine = name;
      if (name == campaign_.machine) continue;
      throw InputError(fmt::format(
          "{}: is of the machine \"{}\", others are of \"{}\"; a campaign is of one machine: add "
          "them one by one",
          file, name, campaign_.machine));
    }
    if (campaign_.machine.empty()) {
      throw InputError(
          fmt::format("{}: no result or recording names its machine; add --machine FILE", where));
    }
  }

  void Date(const std::string& where) {
    std::optional<double> first = options_.measured;
    const auto earlier = [&](double instant) {
      first = std::min(first.value_or(instant), instant);
    };
    if (!first) {
      for (const ResultFile& each : campaign_.results) {
        if (each.measured != 0.0) earlier(each.measured);
      }
      for (const RecordingFile& each : campaign_.recordings) {
        if (const auto started = recording::SecondsOf(each.started)) earlier(*started);
      }
    }
    if (!first) {
      throw InputError(
          fmt::format("{}: no result or recording says when it was measured; add --measured "
                      "2026-11-21T09:00:00Z",
                      where));
    }
    campaign_.measured = *first;
    for (ResultFile& each : campaign_.results) {
      if (each.measured == 0.0 || options_.measured) each.measured = *first;
    }
    if (options_.now > 0.0 && *first > options_.now + kSlack) {
      campaign_.notes.push_back(fmt::format(
          "{}: measured on {}, which is in the future by the clock of this computer; a trend "
          "leaves it out: correct the clock, or add it with --measured",
          where, recording::InstantText(*first)));
    }
  }

  const CampaignOptions& options_;
  Campaign campaign_;
  std::map<std::string, std::string> machines_;  // name -> the file that says so
  std::set<std::string> operators_, serials_, mountings_, linkages_;
};

}  // namespace

std::string Campaign::Sha256() const {
  std::set<std::string> hashes;
  for (const ResultFile& each : results) hashes.insert(each.sha256);
  for (const RecordingFile& each : recordings) hashes.insert(each.sha256);
  for (const TextFile& each : maps) hashes.insert(each.sha256);
  return recording::Sha256OfText(fmt::format("{}", fmt::join(hashes, "\n")));
}

Campaign ReadCampaign(const std::vector<fs::path>& from, const CampaignOptions& options) {
  Gathering gathering(options);
  for (const fs::path& path : from) gathering.Take(path);
  return gathering.Finish(from);
}

}  // namespace abbe::history
