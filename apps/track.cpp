// abbe track: a map that stays true by short tests, temperatures and time.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/conditions.h"
#include "apps/history_options.h"
#include "apps/instruments.h"
#include "apps/machine_recording.h"
#include "apps/map_option.h"
#include "apps/result_file.h"
#include "apps/track_result.h"
#include "history/limits.h"
#include "map/map_file.h"
#include "recording/file_hash.h"
#include "recording/instant.h"
#include "simulation/kinds.h"
#include "track/learn.h"
#include "track/outlook.h"

namespace abbe::apps {
namespace {

namespace fs = std::filesystem;

constexpr double kDayOfTracking = 86400.0;
constexpr double kUsualWalk = 0.05;  // of [population], after a day, before anything is learned

struct TrackArguments {
  fs::path map, machine, out, json;
  std::vector<fs::path> tests, next;
  std::vector<std::string> temperatures, then;
  std::string time, measured;
  std::vector<double> at_mm;
  double days = 7.0;
  std::string store;
  bool learn = false, history = false, quiet = false;
};

double InstantOf(const std::string& option, const std::string& text) {
  if (const auto seconds = recording::SecondsOf(text)) return *seconds;
  throw InputError(
      fmt::format("{} {}: is no instant; write it like 2026-11-21T09:00:00Z", option, text));
}

// "table=24.1"
std::map<std::string, double> TemperaturesOf(const std::string& option,
                                             const std::vector<std::string>& given) {
  std::map<std::string, double> temperatures;
  for (const std::string& each : given) {
    const std::size_t equals = each.find('=');
    double value = 0.0;
    std::size_t read = 0;
    try {
      value = std::stod(each.substr(equals == std::string::npos ? each.size() : equals + 1), &read);
    } catch (const std::exception&) {
      read = 0;
    }
    if (equals == 0 || equals == std::string::npos || read != each.size() - equals - 1) {
      throw InputError(
          fmt::format("{} {}: must be NAME=DEGREES, such as table=24.1", option, each));
    }
    temperatures[each.substr(0, equals)] = value;
  }
  return temperatures;
}

// A short test, or a recording of temperatures alone.
struct Test {
  recording::Recording recording;
  double began = 0.0;
  bool makes_maps = true;
};

class Tracking {
 public:
  explicit Tracking(const TrackArguments& arguments)
      : arguments_(arguments),
        file_(ReadMachineFile(arguments.machine)),
        instruments_(InstrumentsOf(file_)),
        map_(map::ReadMap(arguments.map)),
        drift_(machine::ReadDrift(file_.document.Root())),
        limits_(history::ReadLimits(file_.document.Root())),
        given_(TemperaturesOf("--temperature", arguments.temperatures)) {
    if (arguments.learn && !drift_.walk && !(map_.state() && map_.state()->walk)) {
      drift_.walk = UsualWalk();
    }
  }

  int Run() {
    track::TrackedMap tracked = Begin();
    std::vector<Test> tests = TestsIn(arguments_.tests);
    if (arguments_.history) AddHistory(tracked.time(), tests);
    TrackReport report;
    if (arguments_.learn) tracked = Learned(tracked, tests, report);
    for (const Test& test : tests) Take(test, tracked, report);
    const double now =
        arguments_.time.empty() ? LastOrNow(tracked, tests) : InstantOf("--time", arguments_.time);
    tracked.Follow({now, given_});
    report.watched = track::Watch(tracked, limits_);
    if (!arguments_.next.empty()) report.choice = NextOf(tracked, report);
    const map::ErrorMap map = tracked.Map();
    if (!arguments_.at_mm.empty()) report.at = VectorOf("--at", arguments_.at_mm);
    if (!arguments_.out.empty()) map::WriteMap(map, arguments_.out);
    report.out = arguments_.out;
    if (!arguments_.json.empty()) WriteResult(TrackJson(map, report), arguments_.json);
    if (!arguments_.quiet) fmt::print("{}", TrackText(map, report));
    return kDone;
  }

 private:
  machine::Population UsualWalk() const {
    machine::Population walk = instruments_.machine.population;
    for (double* size : {&walk.positioning, &walk.straightness, &walk.roll, &walk.pitch, &walk.yaw,
                         &walk.squareness, &walk.scale}) {
      *size *= kUsualWalk;
    }
    return walk;
  }

  track::TrackedMap Begin() const {
    track::Conditions begin;
    if (!arguments_.measured.empty()) begin.time = InstantOf("--measured", arguments_.measured);
    begin.temperature = TemperaturesOf("--then", arguments_.then);
    return {instruments_.machine, map_, drift_, begin};
  }

  // After its tests a map stands at the last of them; without any it is asked for now.
  static double LastOrNow(const track::TrackedMap& tracked, const std::vector<Test>& tests) {
    if (!tests.empty()) return tracked.time();
    return std::max(tracked.time(), recording::SecondsOf(recording::UtcNow()).value_or(0.0));
  }

  std::vector<Test> TestsIn(const std::vector<fs::path>& paths) const {
    std::vector<Test> tests;
    for (const fs::path& path : paths) {
      Test test{ReadRecordingOf(instruments_.machine, path)};
      test.began = MustHaveBegan(test.recording);
      test.makes_maps = simulation::KindOf(test.recording).MakesMaps();
      tests.push_back(std::move(test));
    }
    std::stable_sort(tests.begin(), tests.end(),
                     [](const Test& one, const Test& other) { return one.began < other.began; });
    return tests;
  }

  // The recordings of the machine that the history holds since then, as they were added.
  void AddHistory(double since, std::vector<Test>& tests) const {
    HistoryOptions options;
    options.store = arguments_.store;
    options.quiet = true;
    const history::Store store = OpenStore(options, history::Store::Missing::kRefuse);
    std::vector<fs::path> paths;
    for (const history::CampaignHead& campaign : store.List(instruments_.machine.name)) {
      for (const history::RecordingFile& file : store.Read(campaign.id).recordings) {
        const auto started = recording::SecondsOf(file.started);
        if (!started || *started <= since) continue;
        if (!fs::exists(file.path) || recording::Sha256OfFile(file.path) != file.sha256) {
          throw InputError(fmt::format(
              "{}: is no longer the recording that campaign {} of the history holds; bring it back, "
              "or name the tests instead of --history",
              file.path, campaign.id));
        }
        paths.emplace_back(file.path);
      }
    }
    std::vector<Test> kept = TestsIn(paths);
    std::erase_if(kept, [](const Test& test) { return !test.makes_maps; });
    if (kept.empty()) {
      throw InputError(fmt::format("the history holds no test of {} since {}",
                                   instruments_.machine.name, recording::InstantText(since)));
    }
    std::move(kept.begin(), kept.end(), std::back_inserter(tests));
    std::stable_sort(tests.begin(), tests.end(),
                     [](const Test& one, const Test& other) { return one.began < other.began; });
  }

  std::vector<simulation::SimulatedRun> RunsOf(const recording::Recording& recording) const {
    return simulation::SimulateForMap(simulation::SourceOf(recording), map_.model(), instruments_);
  }

  void Take(const Test& test, track::TrackedMap& tracked, TrackReport& report) const {
    if (test.began <= tracked.time()) {
      throw InputError(fmt::format(
          "{}: began at {}, and the map stands at {}: a clock jumped back, or the test is part of the "
          "map",
          test.recording.name, recording::InstantText(test.began),
          recording::InstantText(tracked.time())));
    }
    for (const auto& each : ConditionsIn(test.recording, tracked.sensors(), given_))
      tracked.Follow(each);
    TestReport one{.name = fs::path(test.recording.name).filename().string(),
                   .kind = std::string(simulation::KindOf(test.recording).name()),
                   .began = test.began,
                   .minutes = MinutesOf(test.recording)};
    if (test.makes_maps) {
      one.before = LargestU95(tracked.Map());
      const track::Taken taken = tracked.Take(RunsOf(test.recording), test.began);
      one.noise = taken.noise;
      one.agreement = taken.agreement;
      one.after = LargestU95(tracked.Map());
    }
    report.tests.push_back(std::move(one));
  }

  track::TrackedMap Learned(const track::TrackedMap& start, const std::vector<Test>& tests,
                            TrackReport& report) const {
    std::vector<track::HistoryStep> history;
    track::HistoryStep step;
    for (const Test& test : tests) {
      for (auto& each : ConditionsIn(test.recording, start.sensors(), given_)) {
        step.followed.push_back(std::move(each));
      }
      if (!test.makes_maps) continue;
      step.runs = RunsOf(test.recording);
      step.began = test.began;
      history.push_back(std::exchange(step, {}));
    }
    std::vector<bool> lags;
    for (const map::Warmth& sensor : start.sensors()) {
      const auto stated =
          std::find_if(drift_.sensors.begin(), drift_.sensors.end(),
                       [&](const auto& each) { return each.sensor == sensor.sensor; });
      lags.push_back(stated == drift_.sensors.end() || !stated->lag);
    }
    const track::Learned learned = track::Learn(start, history, lags);
    report.learned =
        LearnedReport{learned.factor, learned.gain, learned.map.walk(), learned.map.sensors()};
    return learned.map;
  }

  track::Choice NextOf(const track::TrackedMap& now, TrackReport& report) const {
    if (limits_.empty()) {
      throw InputError(fmt::format(
          "{}: has no [limits], so no U95 can exceed them; state some, for example EYX = "
          "{{ straightness_um = 3.0 }} (docs/history.md)",
          arguments_.machine.string()));
    }
    if (report.watched.empty()) {
      throw InputError(fmt::format(
          "{}: none of its [limits] is of what a map states: straightness, range, squareness, "
          "volumetric (docs/track.md)",
          arguments_.machine.string()));
    }
    report.days = arguments_.days;
    track::TrackedMap tracked = now;
    const std::vector<Test> tests = TestsIn(arguments_.next);
    for (const Test& test : tests) {
      if (!test.makes_maps) {
        throw InputError(fmt::format("{}: is no test of the map", test.recording.name));
      }
      tracked.Know(RunsOf(test.recording));
    }
    std::vector<track::Candidate> candidates;
    candidates.reserve(tests.size());
    for (const Test& test : tests) {
      candidates.push_back({fs::path(test.recording.name).filename().string(),
                            MinutesOf(test.recording), tracked.Test(RunsOf(test.recording)).test});
    }
    return track::NextTest(tracked, std::move(candidates), limits_,
                           arguments_.days * kDayOfTracking);
  }

  const TrackArguments& arguments_;
  MachineFile file_;
  simulation::Instruments instruments_;
  map::ErrorMap map_;
  machine::Drift drift_;
  history::Limits limits_;
  std::map<std::string, double> given_;
};

}  // namespace

void AddTrack(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<TrackArguments>();
  CLI::App* command =
      program.add_subcommand("track", "Keeps an error map true by short tests, or asks it");
  command->add_option("map", arguments->map, "Error map of abbe fuse or abbe track")->required();
  command->add_option("tests", arguments->tests,
                      "Short tests since then: recordings as for fuse; others give temperatures");
  command->add_option("--machine", arguments->machine, "Machine file with [drift]")->required();
  command->add_option("-o,--out", arguments->out, "The map as it is then (TOML)");
  command->add_option("--time", arguments->time, "When: 2026-11-28T09:00:00Z (now)");
  command->add_option("--temperature", arguments->temperatures,
                      "NAME=DEGREES of a sensor then (as it was last)");
  command->add_option("--at", arguments->at_mm, "x,y,z in mm: the error there with its U95")
      ->delimiter(',')
      ->expected(3);
  command->add_option("--next", arguments->next,
                      "Tests as they were made before: which of them keeps the limits");
  command->add_option("--days", arguments->days, "For so long (7)")->check(PositiveNumber());
  command->add_flag("--history", arguments->history,
                    "Take the tests from the history of the machine, all since the map");
  command->add_option("--store", arguments->store, "The history (that of abbe history)");
  command->add_flag("--learn", arguments->learn,
                    "Learn the walk, and lags that are not stated, from the tests");
  command->add_option("--measured", arguments->measured, "When a map without a state was measured");
  command->add_option("--then", arguments->then, "NAME=DEGREES of a sensor at that time");
  command->add_option("--json", arguments->json, "File for the result as data");
  command->add_flag("--quiet", arguments->quiet, "No tables");
  command->footer(
      "Example: abbe track mill.map.toml sweep_X.csv --machine mill.toml -o today.toml");
  command->callback([arguments, &exit_code] { exit_code = Tracking(*arguments).Run(); });
}

}  // namespace abbe::apps
