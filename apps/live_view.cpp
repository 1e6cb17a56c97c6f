#include "apps/live_view.h"

#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/interrupt.h"
#include "apps/result_file.h"
#include "live/event_log.h"
#include "live/folder_watch.h"
#include "live/page_server.h"
#include "live/row_feed.h"
#include "report/report_page.h"

namespace abbe::apps {
namespace {

using nlohmann::ordered_json;

constexpr double kFarewell = 1.5;  // s for the browsers to take the last events

std::string OneLine(const ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void SayLine(const std::string& line) { fmt::print(stderr, "abbe: {}\n", line); }

class ServedView : public LiveView {
 public:
  ServedView(const LiveOptions& options, const LiveAbout& about)
      : folder_(about.folder),
        watch_(log_, about.folder, SayLine),
        server_(log_, PageOf(about), {options.bind, options.port, ABBE_VERSION}) {
    fmt::print(stderr, "live page: {}\n", server_.url());
  }

  const std::string& url() const override { return server_.url(); }

  std::unique_ptr<recording::Writer> Watch(std::unique_ptr<recording::Writer> writer,
                                           const std::vector<std::string>& columns,
                                           const std::filesystem::path& file) override {
    const bool kept = writer != nullptr;
    feed_ = std::make_unique<live::RowFeed>(log_, columns, kept ? file : std::filesystem::path());
    return feed_->Watch(std::move(writer));
  }

  void Show(const LiveState& state) override {
    ordered_json json = {
        {"done", state.done}, {"total", state.total}, {"note", state.note}, {"fault", state.fault}};
    if (state.done > 0 && state.total > state.done) {
      json["left_s"] = state.elapsed_s * static_cast<double>(state.total - state.done) /
                       static_cast<double>(state.done);
    }
    log_.Publish("state", OneLine(json), "state");
  }

  void Show(const std::string& file, const ordered_json& result) override {
    log_.Publish("result", OneLine({{"file", file}, {"result", result}}), "file " + file);
  }

  void End(const std::string& text) override {
    if (feed_) feed_->Finish();
    watch_.Finish();
    std::string saved = text;
    try {
      const auto page = folder_ / "report.html";
      WriteText(report::ComposeReport(folder_).page, page);
      saved += fmt::format("; the page is saved as {}", page.string());
    } catch (const InputError&) {
      // No result in the folder: nothing to save.
    }
    log_.Publish("end", OneLine({{"text", saved}}), "end");
    server_.Drain(kFarewell);
  }

 private:
  static std::string PageOf(const LiveAbout& about) {
    const ordered_json live = {{"title", about.title},
                               {"version", ABBE_VERSION},
                               {"session", live::kSessionMark},
                               {"ranges", about.ranges}};
    return report::LivePage(about.folder, OneLine(live));
  }

  live::EventLog log_;
  std::filesystem::path folder_;
  live::FolderWatch watch_;
  live::PageServer server_;
  std::unique_ptr<live::RowFeed> feed_;  // first to go
};

struct LiveCommand {
  LiveOptions live;
  std::filesystem::path folder;
};

// Serves the results of a folder as they appear, until Ctrl-C.
int Live(LiveCommand options) {
  options.live.on = true;
  InterruptFlag();
  const auto view = OpenLive(options.live, {.title = "Results", .folder = options.folder});
  view->Show({.note = "Results appear as they are written into the folder"});
  while (!InterruptFlag()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
  return kDone;
}

void AddPlaceOptions(CLI::App& command, LiveOptions& options) {
  command
      .add_option("--live-bind", options.bind,
                  "address that the live page listens on; one that is not this computer's own "
                  "(127.0.0.1) gets a token")
      ->capture_default_str();
  command.add_option("--live-port", options.port, "its port, 0 for a free one")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str();
}

}  // namespace

void AddLiveOptions(CLI::App& command, LiveOptions& options) {
  command.add_flag("--live", options.on, "serve a page that shows the measurement as it goes on");
  AddPlaceOptions(command, options);
}

std::unique_ptr<LiveView> OpenLive(const LiveOptions& options, const LiveAbout& about) {
  if (!options.on) return {};
  return std::make_unique<ServedView>(options, about);
}

void AddLive(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<LiveCommand>();
  CLI::App* command =
      program.add_subcommand("live", "Serve a page with the results of a folder as they appear");
  command->add_option("folder", options->folder, "the folder")->required();
  AddPlaceOptions(*command, options->live);
  command->footer("Example: abbe live measured --live-port 8080");
  command->callback([options, &exit_code] { exit_code = Live(*options); });
}

}  // namespace abbe::apps
