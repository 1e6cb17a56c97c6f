#include "recording/target_test.h"

#include <fmt/format.h>

#include <filesystem>
#include <iterator>
#include <utility>

#include "settings/toml_text.h"

namespace abbe::recording {
namespace {

constexpr int kMaxCycles = 10'000;  // far above any test, to catch typing errors

double ForwardDirection(const TargetTest& test) {
  const double sign = test.targets.rbegin()->second > test.targets.begin()->second ? 1 : -1;
  for (auto here = std::next(test.targets.begin()); here != test.targets.end(); ++here) {
    const double before = std::prev(here)->second;
    if (sign * (here->second - before) <= 0) {
      throw InputError(
          fmt::format("{}: {}[{}]={} after {}: targets must ascend, or descend, all the way",
                      test.file, test.target_name, here->first, here->second, before));
    }
  }
  return sign;
}

std::string HeaderOf(const TargetTest& test) {
  return fmt::format(
      "kind = \"reference\"\naxis = \"{}\"\ntime = \"order\"\nimported_from = {}\n{}", test.axis,
      settings::Quoted(std::filesystem::path(test.file).filename().string()), test.more_header);
}

// Appends the readings of a test in the order of measurement.
class ReadingRows {
 public:
  ReadingRows(const TargetTest& test, Recording& recording) : test_(test), recording_(recording) {}

  void Add(bool is_forward, TargetPlace place, double direction) {
    const double time = order_++;
    const auto& readings = is_forward ? test_.forward : test_.backward;
    const auto reading = readings.find(place);
    if (reading == readings.end()) {
      if (missing_++ > 0) return;
      first_missing_ =
          fmt::format("{}[{},{}]", is_forward ? test_.forward_name : test_.backward_name,
                      place.position, place.cycle);
      return;
    }
    const double row[] = {time,
                          test_.targets.at(place.position) * test_.mm_per_unit,
                          static_cast<double>(place.cycle),
                          direction,
                          reading->second * test_.mm_per_unit,
                          0.0};
    for (std::size_t i = 0; i < std::size(row); ++i) recording_.columns[i].values.push_back(row[i]);
  }

  void WarnOfMissing() {
    if (missing_ == 0) return;
    recording_.warnings.push_back(fmt::format("{}: {} of {} readings are missing, the first is {}",
                                              test_.file, missing_, order_, first_missing_));
  }

 private:
  const TargetTest& test_;
  Recording& recording_;
  int order_ = 0, missing_ = 0;
  std::string first_missing_;
};

}  // namespace

void MustBeLinear(const std::string& file, const std::string& axis) {
  if (axis == "X" || axis == "Y" || axis == "Z") return;
  throw InputError(fmt::format("{}: axis \"{}\": choose X, Y or Z", file, axis));
}

Recording RecordingOf(TargetTest test) {
  MustBeLinear(test.file, test.axis);
  if (test.cycles > kMaxCycles) {
    throw InputError(
        fmt::format("{}: {} cycles: at most {} are read; correct the number or the indices",
                    test.file, test.cycles, kMaxCycles));
  }
  if (test.targets.empty()) throw InputError(fmt::format("{}: no targets", test.file));
  const double forward = ForwardDirection(test);
  const char small = static_cast<char>(test.axis[0] - 'A' + 'a');
  Recording recording;
  recording.name = test.file;
  recording.header = HeaderOf(test);
  recording.columns = {{"time_s", {}},    {fmt::format("{}_mm", small), {}},     {"pass", {}},
                       {"direction", {}}, {fmt::format("ref_{}_mm", small), {}}, {"flags", {}}};
  recording.warnings = std::move(test.warnings);
  ReadingRows rows(test, recording);
  for (int cycle = 1; cycle <= test.cycles; ++cycle) {
    for (const auto& [position, target] : test.targets) rows.Add(true, {position, cycle}, forward);
    for (auto target = test.targets.rbegin(); target != test.targets.rend(); ++target) {
      rows.Add(false, {target->first, cycle}, -forward);
    }
  }
  rows.WarnOfMissing();
  return recording;
}

}  // namespace abbe::recording
