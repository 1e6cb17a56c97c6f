// What many worlds with one hidden effect show together: rates, power against what can be seen, and
// which names stood in for which.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "tests/hidden_effects/judgement.h"

namespace abbe {

class RateTable {
 public:
  // `visible`: standard deviations of the effect; `separable`: those that its best rival leaves;
  // `showable`: those of the largest size that the rig hides.
  void Add(const rig::HiddenEffect& truth, double visible, double separable, double showable,
           const Diagnosis& diagnosis) {
    const bool first = !diagnosis.findings.empty() && Names(diagnosis.findings.front(), truth);
    const std::string name = NameOf(truth);
    wrong_and_certain.Add(diagnosis.verdict == Verdict::kExplained && !first);
    if (separable > kSeen) {
      named_first.Add(first);
      alone.Add(first && diagnosis.verdict == Verdict::kExplained &&
                diagnosis.findings.size() == 1);
      if (first) AddSizes(diagnosis.findings.front(), truth, inside);
      ++named_[std::string(truth.entry->name)][FirstOf(diagnosis)];
    }
    if (showable < kSeen) {
      listed.Add(std::any_of(diagnosis.cannot_show.begin(), diagnosis.cannot_show.end(),
                             [&](const std::string& each) { return each.starts_with(name); }));
    }
    const auto bin = std::upper_bound(kBins.begin(), kBins.end(), std::min(visible, separable));
    power_[static_cast<std::size_t>(bin - kBins.begin())].Add(first);
    by_cause_[std::string(truth.entry->name)].Add(separable > kSeen);
  }

  void Print() const {
    fmt::print("separable and named first: {}; with nothing beside: {}\n", named_first.Text(),
               alone.Text());
    fmt::print("keys of those inside U95: {}\n", inside.Text());
    fmt::print("wrong and certain: {}\n", wrong_and_certain.Text());
    fmt::print("cannot be shown and listed so: {}\n", listed.Text());
    for (std::size_t bin = 0; bin < power_.size(); ++bin) {
      fmt::print(
          "power, {} sigma beside the best rival: {}\n",
          bin == 0 ? fmt::format("below {}", kBins[0]) : fmt::format("from {}", kBins[bin - 1]),
          power_[bin].Text());
    }
    PrintConfusions();
  }

  static constexpr double kSeen = 5.0;

  Rate named_first, alone, inside, wrong_and_certain, listed;

 private:
  // One row for each cause: how many of its worlds were separable, and what was named first there.
  void PrintConfusions() const {
    fmt::print("| hidden | separable | named first |\n|---|---|---|\n");
    for (const auto& [cause, separable] : by_cause_) {
      std::string names;
      const auto found = named_.find(cause);
      if (found != named_.end()) {
        for (const auto& [name, count] : found->second) {
          names += fmt::format("{}{} {}", names.empty() ? "" : ", ",
                               name == cause ? "itself" : name, count);
        }
      }
      fmt::print("| `{}` | {} | {} |\n", cause, separable.Text(), names.empty() ? "-" : names);
    }
  }

  static std::string FirstOf(const Diagnosis& diagnosis) {
    if (diagnosis.findings.empty()) return std::string(diagnosis::Name(diagnosis.verdict));
    return diagnosis.findings.front().score.candidate.cause->id;
  }

  static constexpr std::array<double, 6> kBins{1.0, 2.0, 5.0, 10.0, 20.0, 100.0};
  std::array<Rate, kBins.size() + 1> power_;
  std::map<std::string, Rate> by_cause_;
  std::map<std::string, std::map<std::string, int>> named_;  // in separable worlds
};

}  // namespace abbe
