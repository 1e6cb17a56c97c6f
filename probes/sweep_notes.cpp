#include "probes/sweep_notes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>

#include "probes/sweep_uncertainty.h"

namespace abbe::probes {
namespace {

// The effect of an error in the position of the head, in um per mm: the straightness that the
// measured angles produce at the end of such a lever.
std::string LeverText(const SweepResult& result, const GroupErrors& errors,
                      const SweepGauge& gauge) {
  std::string text;
  for (std::size_t i = 3; i < kComponents; ++i) {
    const std::string& name = result.components[i].component.name;
    const int across = name[1] - 'X';
    text += fmt::format("{}{} by", text.empty() ? "" : " and ", name);
    for (int along = 0; along < 3; ++along) {
      // -(w x e) in the direction `across`, w the rows 0 to 2 of the errors.
      Eigen::VectorXd moved = Eigen::VectorXd::Zero(errors.cols());
      if (along != across) {
        const double sign = (along + 1) % 3 == across ? -1.0 : 1.0;
        moved = sign * errors.row(3 - along - across).transpose();
      }
      const Eigen::VectorXd bow = gauge.StationMeans(gauge.Apply(SweepGauge::Kind::kLine, moved));
      text += fmt::format("{} {:.2g}", along == 0 ? "" : ",",
                          (bow.maxCoeff() - bow.minCoeff()) * 1e3);  // um per mm
    }
  }
  return text;
}

struct Share {
  double share = 0.0;  // of the variance
  std::string name;
};

// The component whose variance a source with these standard uncertainties is the largest share of.
Share LargestShare(const PerComponent& source, const SweepResult& result) {
  Share largest;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const ComponentResult& component = result.components[i];
    const auto& budget = component.budget;
    const double all = std::inner_product(budget.begin(), budget.end(), budget.begin(), 0.0);
    const double share = all > 0.0 ? source[i] * source[i] / all : 0.0;
    if (share > largest.share) largest = {share, component.component.name};
  }
  return largest;
}

// How much rests on the stated form of the target, which one sweep cannot check.
std::optional<std::string> FormNote(const TargetSettings& target, const SweepResult& result) {
  constexpr double kMatters = 0.1;  // of a variance
  constexpr double kTimes = 3.0;
  constexpr std::size_t kForm = kSources - 1;
  if (target.form_known_to == 1.0) return std::nullopt;
  PerComponent form{};
  for (std::size_t i = 0; i < form.size(); ++i) form[i] = result.components[i].budget[kForm];
  const auto [most, name] = LargestShare(form, result);
  if (most < kMatters) return std::nullopt;
  const double flatter = std::pow(UncheckedTimes(target.form_known_to), -2);
  return fmt::format(
      "{:.0f} % of the variance of {} rests on target.form_nm = {:.3g}, which one sweep cannot check: "
      "u holds it as known to a factor of {:.3g}; on a target with {:.0f} times that form U95 would "
      "be {:.1f} times as large. Measure the flatness of the faces and state it with form_known_to "
      "= 1, or sweep once more with the target shifted or reversed and fuse",
      100.0 * most, name, target.form * 1e9, target.form_known_to, kTimes,
      std::sqrt(1.0 + most * (kTimes * kTimes * flatter - 1.0)));
}

// What probes of usual linearity would add where the machine file does not state it.
std::optional<std::string> LinearityNote(const HeadSettings& head, const SweepResult& result,
                                         const PerComponent& usual) {
  constexpr double kMatters = 1.5;  // of a U95
  if (!head.assumed.contains("head.tolerance.linearity_um")) return std::nullopt;
  const auto [most, name] = LargestShare(usual, result);
  const double times = std::sqrt(1.0 + most);
  if (times < kMatters) return std::nullopt;
  return fmt::format(
      "the linearity of the probes is not in u: of 0.1 % of their range, which is usual, U95 of {} "
      "would be {:.1f} times as large over these gaps; state head.tolerance.linearity_um by their "
      "certificate (its limit / 1.7), 0 where their characteristics are corrected",
      name, times);
}

// What the directions of the sweep leave open: the reversal.
std::optional<std::string> DirectionNote(const StationMeans& means, const SweepResult& result) {
  if (means.directions.size() == 1) {
    return fmt::format(
        "the sweep has {} passes only: the errors are those of this direction, and u holds no "
        "reversal; the mean of both directions, as ISO 230-1 states it, differs by half the "
        "reversal; record passes in both",
        means.directions.front() > 0 ? "forward" : "backward");
  }
  if (means.noise.dof > 0.0) return std::nullopt;
  std::string names;
  for (const ComponentResult& component : result.components) {
    if (!component.reversal->seen) continue;
    names += (names.empty() ? "" : ", ") + component.component.name;
  }
  if (names.empty()) return std::nullopt;
  return fmt::format(
      "one pass: forward and backward of {} differ by more than noise and drift, but a probe that "
      "jumps at the turn looks like that reversal; a second pass tells",
      names);
}

std::vector<std::string> AssumptionNotes(const HeadSettings& head, const SweepResult& result,
                                         const GroupErrors& errors, const SweepGauge& gauge) {
  std::vector<std::string> notes;
  const std::string place = fmt::format("head.axis_{}.position_mm", result.axis);
  if (head.assumed.contains(place)) {
    notes.push_back(
        fmt::format("{} is not in the machine file and is taken as [0, 0, 0]: each mm of it in x, "
                    "y, z moves {} um; state it",
                    place, LeverText(result, errors, gauge)));
  }
  const std::string turn = fmt::format("head.axis_{}.rotation", result.axis);
  if (head.assumed.contains(turn)) {
    notes.push_back(fmt::format(
        "{} is not in the machine file: a head that stands otherwise changes names and signs of "
        "the errors; state it",
        turn));
  }
  const auto placed = [&](char probe) {
    return !head.assumed.contains(fmt::format("head.probe_{}.position_mm", probe));
  };
  if (!std::ranges::all_of(std::string_view("abcde"), placed)) {
    notes.push_back(
        "probes without position_mm are taken to stand as drawn, 10 and 20 mm from the edge: 1 % "
        "of it moves an angle by 1 %; state them");
  }
  return notes;
}

}  // namespace

std::vector<std::string> NotesOn(const SweepResult& result, const StationMeans& means,
                                 const GroupErrors& errors, const SweepGauge& gauge,
                                 const HeadSettings& head, const TargetSettings& target,
                                 const PerComponent& usual_linearity) {
  std::vector<std::string> notes;
  for (std::optional<std::string> note : {DirectionNote(means, result), FormNote(target, result),
                                          LinearityNote(head, result, usual_linearity)}) {
    if (note) notes.push_back(*std::move(note));
  }
  std::ranges::move(AssumptionNotes(head, result, errors, gauge), std::back_inserter(notes));
  return notes;
}

}  // namespace abbe::probes
