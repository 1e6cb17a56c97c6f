#include "study/hidden/rate_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace abbe::study {
namespace {

constexpr std::array<double, 6> kBins{1.0, 2.0, 5.0, 10.0, 20.0, 100.0};

std::string FirstOf(const Diagnosis& diagnosis) {
  if (diagnosis.findings.empty()) return std::string(diagnosis::Name(diagnosis.verdict));
  return diagnosis.findings.front().score.candidate.cause->id;
}

class RateTable {
 public:
  void Add(const Row& row) {
    const bool first = row.at("is_first");
    const auto visible = row.at("visible").get<double>(), beside = row.at("beside").get<double>();
    const std::string cause = row.at("cause");
    wrong_and_certain_.Add(row.at("verdict") == "explained" && !first);
    if (beside > kSeen) {
      named_first_.Add(first);
      alone_.Add(row.at("is_alone").get<bool>());
      inside_.Add(RateOf(row, "sizes", "sizes_inside"));
      ++named_[cause][row.at("named").get<std::string>()];
    }
    if (row.at("largest").get<double>() < kSeen) listed_.Add(row.at("is_listed").get<bool>());
    if (row.contains("at_floor")) at_floor_.Add(row.at("at_floor").get<bool>());
    const auto bin = std::ranges::upper_bound(kBins, std::min(visible, beside));
    power_[bin - kBins.begin()].Add(first);
    by_cause_[cause].Add(beside > kSeen);
  }

  std::string Text() const {
    std::string text = fmt::format("Named first with nothing beside: {}\n\n", alone_.Text());
    text += "| standard deviations beside the best rival | named first |\n|---|---|\n";
    for (std::size_t bin = 0; bin < power_.size(); ++bin) {
      text += bin == 0 ? fmt::format("| below {} |", kBins[0])
                       : fmt::format("| from {} |", kBins[bin - 1]);
      text += fmt::format(" {} |\n", power_[bin].Text());
    }
    return text + "\n" + Confusions();
  }

  std::vector<Bound> Bounds() const {
    return {{"separable and named first", named_first_, 0.98, 1.0},
            {"its sizes inside U95", inside_, 0.90, 0.99},
            {"certain and wrong", wrong_and_certain_, 0.0, 0.01},
            {"cannot be shown and listed so", listed_, 0.95, 1.0},
            {"held out, within 5 % of the noise", at_floor_, 0.99, 1.0}};
  }

 private:
  // One line for each cause: how many of its worlds were separable, and what was named first there.
  std::string Confusions() const {
    std::string text = "| hidden | separable | named first |\n|---|---|---|\n";
    for (const auto& [cause, separable] : by_cause_) {
      std::string names;
      if (const auto found = named_.find(cause); found != named_.end()) {
        for (const auto& [name, count] : found->second) {
          names += fmt::format("{}{} {}", names.empty() ? "" : ", ",
                               name == cause ? "itself" : name, count);
        }
      }
      text +=
          fmt::format("| `{}` | {} | {} |\n", cause, separable.Text(), names.empty() ? "-" : names);
    }
    return text;
  }

  Rate named_first_, alone_, inside_, wrong_and_certain_, listed_, at_floor_;
  std::array<Rate, kBins.size() + 1> power_;
  std::map<std::string, Rate> by_cause_;
  std::map<std::string, std::map<std::string, int>> named_;  // in separable worlds
};

}  // namespace

Row JudgeOne(const rig::HiddenEffect& truth, const Visible& visible, const Diagnosis& diagnosis) {
  const bool first = !diagnosis.findings.empty() && Names(diagnosis.findings.front(), truth);
  Rate inside;
  if (first) AddSizes(diagnosis.findings.front(), truth, inside);
  const std::string name = NameOf(truth);
  return {{"cause", truth.entry->name},
          {"visible", visible.alone},
          {"beside", visible.beside},
          {"largest", visible.largest},
          {"named", FirstOf(diagnosis)},
          {"is_first", first},
          {"is_alone",
           first && diagnosis.verdict == Verdict::kExplained && diagnosis.findings.size() == 1},
          {"sizes", inside.worlds},
          {"sizes_inside", inside.met},
          {"is_listed", std::ranges::any_of(diagnosis.cannot_show, [&](const std::string& each) {
             return each.starts_with(name);
           })}};
}

Summary SumOfOne(const std::string& /*variant*/, const std::vector<Row>& rows) {
  RateTable table;
  for (const Row& row : rows) table.Add(row);
  return {table.Text(), table.Bounds()};
}

}  // namespace abbe::study
