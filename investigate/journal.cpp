#include "investigate/journal.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <utility>

#include "failure/failure.h"
#include "recording/instant.h"
#include "recording/recording_file.h"
#include "recording/whole_file.h"

namespace abbe::investigate {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char *kData = "investigation.json", *kText = "investigation.txt";
constexpr std::size_t kWeighedInText = 6;

Json JsonOf(const Minutes& minutes) {
  return {{"set_up", minutes.set_up},
          {"waiting", minutes.waiting},
          {"run", minutes.run},
          {"total", minutes.total()}};
}

Json JsonOf(const std::vector<Probable>& list) {
  Json json = Json::array();
  for (const Probable& each : list) {
    json.push_back({{"name", each.name}, {"probability", each.probability}});
  }
  return json;
}

Json JsonOf(const Choice& choice) {
  Json weighed = Json::array();
  for (const WeighedRun& run : choice.weighed) {
    weighed.push_back({{"text", run.text},
                       {"minutes", run.minutes.total()},
                       {"bits", run.bits},
                       {"bits_per_minute", run.bits_per_minute()}});
  }
  return {{"entropy_bits", choice.entropy},
          {"nothing", choice.nothing},
          {"worlds", JsonOf(choice.worlds)},
          {"weighed", std::move(weighed)},
          {"never_shown", choice.never_shown}};
}

Json ReadJson(const fs::path& path) {
  std::ifstream file(path);
  try {
    return Json::parse(file);
  } catch (const Json::parse_error& error) {
    throw InputError(
        fmt::format("{}: is no journal of an investigation: not valid JSON at byte {}; "
                    "choose another folder",
                    path.string(), error.byte));
  } catch (const Json::out_of_range&) {
    throw InputError(
        fmt::format("{}: contains a number beyond 1e308; choose another folder", path.string()));
  }
}

void WriteWhole(const std::string& text, const fs::path& path) {
  recording::WholeFile file(path);
  file.Append(text);
  file.Finish();
}

std::string ProbableText(const Json& list) {
  std::string text;
  for (const Json& each : list) {
    text += fmt::format("{}{} {:.3f}", text.empty() ? "" : ", ", each.at("name").get<std::string>(),
                        each.at("probability").get<double>());
  }
  return text;
}

std::string OutcomeText(const Json& after) {
  std::string text = fmt::format("  came: {}", after.at("verdict").get<std::string>());
  if (!after.at("findings").empty()) text += ", " + ProbableText(after.at("findings"));
  for (const Json& left : after.at("left")) text += ", left: " + left.get<std::string>();
  return text + (after.at("certain").get<bool>() ? " (certain)\n" : "\n");
}

std::string StepText(const Json& step) {
  const Json& before = step.at("before");
  std::string text = fmt::format(
      "{}. {}\n  before: {:.2f} bits open; {}\n  expected: {:.3f} bits in {:.1f} min ({:.1f} set "
      "up, {:.1f} waiting, {:.1f} run)\n",
      step.at("number").get<int>(), step.at("text").get<std::string>(),
      before.at("entropy_bits").get<double>(), ProbableText(before.at("worlds")),
      step.at("bits").get<double>(), step.at("minutes").at("total").get<double>(),
      step.at("minutes").at("set_up").get<double>(), step.at("minutes").at("waiting").get<double>(),
      step.at("minutes").at("run").get<double>());
  const Json& weighed = before.at("weighed");  // the chosen one first
  for (std::size_t i = 1; i < std::min(weighed.size(), kWeighedInText); ++i) {
    const Json& run = weighed[i];
    text += fmt::format("  weighed: {:.4f} bits/min  {}\n", run.at("bits_per_minute").get<double>(),
                        run.at("text").get<std::string>());
  }
  if (step.contains("file")) {
    text += fmt::format("  recorded: {}\n", step.at("file").get<std::string>());
  }
  if (step.contains("after")) text += OutcomeText(step.at("after"));
  return text;
}

}  // namespace

Outcome OutcomeOf(const diagnosis::Diagnosis& diagnosis) {
  Outcome outcome{.verdict = std::string(Name(diagnosis.verdict))};
  for (const diagnosis::Finding& finding : diagnosis.findings) {
    outcome.findings.push_back({finding.score.candidate.Name(), finding.probability});
  }
  for (const diagnosis::Leftover& left : diagnosis.leftovers) {
    outcome.left.push_back(fmt::format("{} over {}", left.object, left.variable));
  }
  return outcome;
}

Journal::Journal(fs::path folder, Json data) : folder_(std::move(folder)), data_(std::move(data)) {}

Journal Journal::In(const fs::path& folder, const About& about) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw InputError(fmt::format("--out {}: cannot be made: {}; choose another folder",
                                 folder.string(), error.message()));
  }
  const fs::path path = folder / kData;
  if (!fs::exists(path)) {
    Journal journal(folder, {{"command", "investigate"},
                             {"machine", about.machine},
                             {"recorder", about.recorder},
                             {"started", recording::InstantText(about.started)},
                             {"steps", Json::array()}});
    journal.Write();
    return journal;
  }
  Journal journal(folder, ReadJson(path));
  if (!journal.IsWhole()) {
    throw InputError(fmt::format(
        "{}: is no journal of an investigation: a step lacks what it must state; choose "
        "another folder",
        path.string()));
  }
  const auto refuse = [&](const char* key, const std::string& wanted, const char* what) {
    const std::string found = journal.data_.value(key, "");
    if (found == wanted) return;
    throw InputError(
        fmt::format("{}: is of {} \"{}\", not \"{}\"; give that one, or another "
                    "folder",
                    path.string(), what, found, wanted));
  };
  refuse("command", "investigate", "the command");
  refuse("machine", about.machine, "the machine");
  refuse("recorder", about.recorder, "the recorder");
  return journal;
}

// Reads all that the functions below read.
bool Journal::IsWhole() const {
  try {
    for (const char* key : {"command", "machine", "recorder"}) data_.at(key).get<std::string>();
    std::size_t number = 0;
    for (const Json& step : data_.at("steps").get_ref<const Json::array_t&>()) {
      if (step.at("number") != ++number) return false;
      step.at("path").get<std::string>();
    }
    started();
    recordings();
    outcomes();
    stalled();
    Text();
    return true;
  } catch (const Json::exception&) {
    return false;
  }
}

double Journal::started() const {
  return recording::SecondsOf(data_.at("started").get<std::string>()).value_or(0.0);
}

double Journal::spent() const {
  double minutes = 0.0;
  for (const Json& step : data_.at("steps")) {
    if (step.contains("file")) minutes += step.at("minutes").at("total").get<double>();
  }
  return minutes;
}

std::size_t Journal::steps() const { return data_.at("steps").size(); }

std::vector<fs::path> Journal::recordings() const {
  std::vector<fs::path> paths;
  for (const Json& step : data_.at("steps")) {
    if (step.contains("file")) paths.push_back(folder_ / step.at("file").get<std::string>());
  }
  return paths;
}

bool Journal::IsWaiting() const { return steps() > 0 && !last().contains("file"); }
const Json& Journal::last() const { return data_.at("steps").back(); }
std::string Journal::WaitingText() const { return last().at("text"); }
fs::path Journal::WaitingPath() const { return folder_ / last().at("path").get<std::string>(); }
bool Journal::IsEnded() const { return data_.contains("ended"); }
std::size_t Journal::number() const { return IsWaiting() ? steps() : steps() + 1; }

std::vector<Outcome> Journal::outcomes() const {
  std::vector<Outcome> outcomes;
  for (const Json& step : data_.at("steps")) {
    if (!step.contains("after")) continue;
    const Json& after = step.at("after");
    Outcome outcome{.verdict = after.at("verdict"), .is_certain = after.at("certain")};
    for (const Json& each : after.at("findings")) {
      outcome.findings.push_back({each.at("name"), each.at("probability")});
    }
    for (const Json& each : after.at("left")) outcome.left.push_back(each);
    outcomes.push_back(std::move(outcome));
  }
  return outcomes;
}

int Journal::stalled() const {
  constexpr double kSettled = 0.1;  // of what was promised
  int stalled = 0;
  for (const Json& step : data_.at("steps")) {
    if (!step.contains("after") || !step.at("after").contains("entropy_bits")) continue;
    const double before = step.at("before").at("entropy_bits"), bits = step.at("bits"),
                 after = step.at("after").at("entropy_bits");
    stalled = after > before - kSettled * bits ? stalled + 1 : 0;
  }
  return stalled;
}

std::vector<std::string> Journal::texts() const {
  std::vector<std::string> texts;
  for (const Json& step : data_.at("steps")) {
    if (step.contains("file")) texts.push_back(step.at("text"));
  }
  return texts;
}

void Journal::Decide(const Choice& choice) {
  const WeighedRun& best = choice.weighed.front();
  const std::size_t number = steps() + 1;
  const std::string path = fmt::format("{:02}_path.csv", number);
  // A crash may have left it; it is no measurement.
  std::error_code ignored;
  fs::remove(folder_ / path, ignored);
  recording::Write(best.path, folder_ / path);
  data_["steps"].push_back({{"number", number},
                            {"text", best.text},
                            {"minutes", JsonOf(best.minutes)},
                            {"bits", best.bits},
                            {"before", JsonOf(choice)},
                            {"path", path}});
  Write();
}

void Journal::Recorded(const fs::path& recording) {
  data_["steps"].back()["file"] = recording.string();
  Write();
}

void Journal::Diagnosed(const Outcome& outcome, const Choice* then) {
  Json& after = data_["steps"].back()["after"];
  after = {{"verdict", outcome.verdict},
           {"findings", JsonOf(outcome.findings)},
           {"left", outcome.left},
           {"certain", outcome.is_certain}};
  if (then != nullptr) after["entropy_bits"] = then->entropy;
  Write();
}

void Journal::End(const std::string& why, const Choice* last_choice) {
  const std::vector<Outcome> all = outcomes();
  data_["ended"] = {{"why", why},
                    {"minutes", spent()},
                    {"verdict", all.empty() ? "" : all.back().verdict},
                    {"certain", !all.empty() && all.back().is_certain}};
  if (last_choice != nullptr) data_["ended"]["state"] = JsonOf(*last_choice);
  Write();
}

void Journal::Reopen() {
  data_.erase("ended");
  Write();
}

std::string Journal::Text() const {
  std::string text =
      fmt::format("Investigation of {}, begun {}\n\n", data_.at("machine").get<std::string>(),
                  data_.at("started").get<std::string>());
  for (const Json& step : data_.at("steps")) text += StepText(step);
  if (IsEnded()) {
    const Json& ended = data_.at("ended");
    text += fmt::format("\nEnded after {:.1f} min: {}. Verdict: {}, {}.\n",
                        ended.at("minutes").get<double>(), ended.at("why").get<std::string>(),
                        ended.at("verdict").get<std::string>(),
                        ended.at("certain").get<bool>() ? "certain" : "not certain");
  }
  return text;
}

void Journal::Write() const {
  WriteWhole(data_.dump(1) + "\n", folder_ / kData);
  WriteWhole(Text(), folder_ / kText);
}

}  // namespace abbe::investigate
