#include "recording/laser_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "recording/line_reader.h"
#include "recording/target_test.h"
#include "settings/unit.h"
#include "settings/words.h"

namespace abbe::recording {
namespace {

constexpr double kMmPerMicrometre = settings::kMicrometre / settings::kMillimetre;
constexpr int kMostLaserTargets = 1'000'000;

class LaserTable {
 public:
  LaserTable(const std::filesystem::path& path, std::string axis)
      : lines_(path), test_{path.string(), std::move(axis)} {}

  TargetTest Read() {
    while (const auto line = lines_.Next()) {
      const std::string_view text = settings::Trimmed(*line);
      if (text.empty()) continue;
      if (text.ends_with("::")) {
        section_ = text.substr(0, text.size() - 2);
        takes_targets_ = takes_deviations_ = false;
        if (section_ == "EOF") return Complete();
        continue;
      }
      Take(text);
    }
    throw InputError(test_.file +
                     (section_.empty()
                          ? ": no section such as TARGET DATA::, not a table of a laser"
                          : ": ends without EOF::, it is truncated; copy it again"));
  }

 private:
  [[noreturn]] void RefuseHere(const std::string& what) const {
    throw InputError(fmt::format("{}:{}: {}", test_.file, lines_.number(), what));
  }

  double Number(std::string_view word) const {
    double value = 0.0;
    const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value)) {
      RefuseHere(fmt::format("\"{}\" is not a number (with a decimal point)", word));
    }
    return value;
  }

  int Count(std::string_view word, int most) const {
    const double value = Number(word);
    if (!(value >= 1.0 && value <= most) || value != std::floor(value)) {
      RefuseHere(fmt::format("\"{}\" is no number from 1 to {}", word, most));
    }
    return static_cast<int>(value);
  }

  void Take(std::string_view text) {
    const std::size_t colon = text.find(':');
    const bool has_key = colon != std::string_view::npos;
    const std::string_view key = settings::Trimmed(text.substr(0, colon));
    const std::string_view value = has_key ? settings::Trimmed(text.substr(colon + 1)) : "";
    if (section_ == "HEADER" && has_key) return TakeHeader(key, value);
    if (section_ == "TARGET DATA") return has_key ? TakeTargetKey(key, value) : TakeTargets(text);
    if (section_ == "USER-TEXT" && key == "Axis") return TakeAxis(value);
    if (section_ == "RUNS" && key == "Run-count") {
      runs_ = Count(value, kMostLaserTargets);
    } else if (section_ == "DEVIATIONS") {
      if (!has_key) return TakeDeviation(text);
      takes_deviations_ = key == "Run Target Data";
    }
  }

  void TakeHeader(std::string_view key, std::string_view value) {
    if (key != "File type" || value == "rtl" || value == "RTL") return;
    RefuseHere(fmt::format(
        "a file of type \"{}\"; read are linear positioning tests (rtl); write others as CSV",
        value));
  }

  void TakeTargetKey(std::string_view key, std::string_view value) {
    takes_targets_ = key == "Targets";
    if (key == "Target-count") count_ = Count(value, kMostLaserTargets);
    if (takes_targets_ && !value.empty()) TakeTargets(value);
    if (key != "Flags") return;
    const auto flags = settings::WordsOf(value);
    if (flags.size() < 2 || (flags[1] != "0" && flags[1] != "1")) {
      RefuseHere(
          fmt::format("flags \"{}\", the second of which is neither 0 (both directions) nor "
                      "1 (one)",
                      value));
    }
    if (flags[1] == "1") {
      RefuseHere(
          "a test in one direction; how its runs are numbered is not known: write its readings as "
          "a CSV of kind \"reference\"");
    }
    goes_back_ = true;
  }

  void TakeTargets(std::string_view text) {
    if (!takes_targets_) RefuseHere(fmt::format("\"{}\" before \"Targets :\"", text));
    for (const std::string_view word : settings::WordsOf(text)) {
      test_.targets.emplace(static_cast<int>(test_.targets.size()) + 1, Number(word));
    }
  }

  void TakeAxis(std::string_view value) {
    if (value.empty()) return;
    if (test_.axis.empty()) test_.axis = value;
    if (test_.axis != value) {
      test_.warnings.push_back(
          fmt::format("{}: states axis \"{}\", read as axis {}", test_.file, value, test_.axis));
    }
  }

  void TakeDeviation(std::string_view text) {
    if (!takes_deviations_) RefuseHere(fmt::format("\"{}\" before \"Run Target Data:\"", text));
    const auto words = settings::WordsOf(text);
    if (words.size() != 3) RefuseHere(fmt::format("\"{}\" is not run, target, deviation", text));
    if (runs_ == 0 || test_.targets.empty()) RefuseHere("deviations before runs and targets");
    const int run = Count(words[0], runs_);
    const int target = Count(words[1], static_cast<int>(test_.targets.size()));
    const bool is_back = run % 2 == 0;
    const double reading = test_.targets.at(target) + kMmPerMicrometre * Number(words[2]);
    auto& readings = is_back ? test_.backward : test_.forward;
    if (!readings.emplace(TargetPlace{target, (run + 1) / 2}, reading).second) {
      RefuseHere(fmt::format("run {}, target {} is given twice: keep one", run, target));
    }
    CheckOrder(run, target);
  }

  // Whether the order of the lines contradicts the direction of their run.
  void CheckOrder(int run, int target) {
    const bool goes_on = run == last_run_;
    const bool descends = goes_on && target < last_target_;
    const bool ascends = goes_on && target > last_target_;
    last_run_ = run;
    last_target_ = target;
    if (run % 2 == 1 && descends) {
      RefuseHere(
          fmt::format("run {} goes back along the targets, but its number is odd: the first "
                      "of a cycle goes forwards",
                      run));
    }
    if (run % 2 == 0 && ascends && !goes_back_) {
      RefuseHere(
          fmt::format("run {} goes along the targets, and no Flags say that runs with even "
                      "numbers go back; write the readings as a CSV of kind \"reference\"",
                      run));
    }
  }

  TargetTest Complete() {
    const int targets = static_cast<int>(test_.targets.size());
    if (targets != count_) {
      throw InputError(fmt::format("{}: {} targets, but Target-count is {}; correct one of them",
                                   test_.file, targets, count_));
    }
    if (test_.forward.empty() && test_.backward.empty()) {
      throw InputError(test_.file + ": no deviations in DEVIATIONS::");
    }
    const double readings = static_cast<double>(test_.forward.size() + test_.backward.size());
    constexpr double kSparse = 0.01;
    if (readings < kSparse * runs_ * targets) {
      throw InputError(fmt::format("{}: {} readings of {} runs of {} targets; correct Run-count",
                                   test_.file, readings, runs_, targets));
    }
    if (test_.axis.empty()) {
      throw InputError(test_.file + ": does not state its axis; give it with --axis X");
    }
    test_.cycles = (runs_ + 1) / 2;
    return std::move(test_);
  }

  LineReader lines_;
  TargetTest test_;
  std::string section_;
  bool takes_targets_ = false, takes_deviations_ = false, goes_back_ = false;
  int count_ = 0, runs_ = 0, last_run_ = 0, last_target_ = 0;
};

}  // namespace

Recording ReadLaserTable(const std::filesystem::path& path, const std::string& axis) {
  return RecordingOf(LaserTable(path, axis).Read());
}

}  // namespace abbe::recording
