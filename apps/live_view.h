// The live page of a command: `--live` of sweep, record and align, and `abbe live FOLDER`.
//
//   const auto view = OpenLive(live, {.title = "Sweep X", .folder = out});
//   const auto watched = Watched(view.get(), std::move(writer), columns, path);
//
// Where abbe was built without the folder live/ (ABBE_LIVE), there is no such option and no view.
// Data flow one way, from the command to the page.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "recording/recording_file.h"

namespace abbe::apps {

struct MachineFile;

struct LiveOptions {
  bool on = false;
  std::string bind = "127.0.0.1";
  int port = 0;
};

// --live, --live-bind, --live-port.
void AddLiveOptions(CLI::App& command, LiveOptions& options);

struct LiveAbout {
  std::string title = {};
  std::filesystem::path folder = {};          // its results are sections
  std::map<std::string, double> ranges = {};  // um, of the gaps by column
};

// What a page shows beside rows and results.
struct LiveState {
  std::size_t done = 0, total = 0;
  double elapsed_s = 0.0;  // of the computer
  std::string note = {}, fault = {};
};

class LiveView {
 public:
  virtual ~LiveView() = default;
  virtual const std::string& url() const = 0;
  // A writer that also feeds the page, in place of `writer` (none: rows go to the page only).
  virtual std::unique_ptr<recording::Writer> Watch(std::unique_ptr<recording::Writer> writer,
                                                   const std::vector<std::string>& columns,
                                                   const std::filesystem::path& file) = 0;
  virtual void Show(const LiveState& state) = 0;
  // A result that is not in the folder yet, under the name that it will have there.
  virtual void Show(const std::string& file, const nlohmann::ordered_json& result) = 0;
  // Saves the page of the folder as its report.html, tells the browsers and waits a moment for
  // them.
  virtual void End(const std::string& text) = 0;
};

// None without --live. Prints the address. DeviceError when the port is taken.
std::unique_ptr<LiveView> OpenLive(const LiveOptions& options, const LiveAbout& about);

// The writer, watched where there is a view.
std::unique_ptr<recording::Writer> Watched(LiveView* view,
                                           std::unique_ptr<recording::Writer> writer,
                                           const std::vector<std::string>& columns,
                                           const std::filesystem::path& file);

std::map<std::string, double> GapRanges(const MachineFile& file);

}  // namespace abbe::apps
