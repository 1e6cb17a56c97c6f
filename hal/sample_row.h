// Sets of samples as rows of a recording, with counts of the bad ones.
//
// A sample that is not good becomes NaN (an uncertain one its number), and its cause a bit of the
// row's flags.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "hal/sample_source.h"

namespace abbe::hal {

class SampleRow {
 public:
  // The column of each channel.
  SampleRow(std::vector<Channel> channels, std::vector<std::size_t> columns);

  // Stores the samples in their columns and returns the flags of the set; `jumped`: time went on by
  // more than it should before it.
  std::uint32_t Fill(const SampleSet& set, std::span<double> row, bool jumped = false);

  std::uint64_t flagged() const { return flagged_; }  // sets with a flag
  double worst_skew_s() const { return worst_skew_s_; }
  // "probe_a_um was bad in 812 rows, last: frozen"; empty when none was.
  std::string WorstChannel() const;

 private:
  struct Bad {
    std::uint64_t rows = 0;
    Cause last = Cause::kNone;
  };
  std::vector<Channel> channels_;
  std::vector<std::size_t> columns_;
  std::vector<Bad> bad_;  // for each channel
  std::uint64_t flagged_ = 0;
  double worst_skew_s_ = 0.0;
};

}  // namespace abbe::hal
