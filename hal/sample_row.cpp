#include "hal/sample_row.h"

#include <fmt/format.h>

#include <algorithm>

#include "hal/sample_flag.h"

namespace abbe::hal {

SampleRow::SampleRow(std::vector<Channel> channels, std::vector<std::size_t> columns)
    : channels_(std::move(channels)), columns_(std::move(columns)), bad_(channels_.size()) {}

std::uint32_t SampleRow::Fill(const SampleSet& set, std::span<double> row, bool jumped) {
  std::uint32_t flags = jumped ? FlagOf(Cause::kClockJump) : 0;
  for (std::size_t i = 0; i < set.samples.size(); ++i) {
    const Sample& sample = set.samples[i];
    row[columns_[i]] = sample.value;
    flags |= FlagOf(sample.cause);
    if (sample.quality == Quality::kBad) {
      ++bad_[i].rows;
      bad_[i].last = sample.cause;
    }
  }
  flagged_ += flags != 0 ? 1 : 0;
  worst_skew_s_ = std::max(worst_skew_s_, set.skew_s);
  return flags;
}

std::string SampleRow::WorstChannel() const {
  const auto worst = std::max_element(bad_.begin(), bad_.end(),
                                      [](const Bad& a, const Bad& b) { return a.rows < b.rows; });
  if (worst == bad_.end() || worst->rows == 0) return {};
  return fmt::format("{} was bad in {} rows, last: {}", channels_[worst - bad_.begin()].name,
                     worst->rows, NameOf(worst->last));
}

}  // namespace abbe::hal
