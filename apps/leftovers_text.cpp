#include "apps/leftovers_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <numbers>

#include "simulation/variables.h"

namespace abbe::apps {
namespace {

using diagnosis::Leftover;

// The period of a spectral line at a shaft, which separates form, bearing, teeth and vibration.
std::string PeriodText(const Leftover& leftover) {
  if (leftover.period == 0.0 || !leftover.object.starts_with("sensor_")) return "";
  if (leftover.variable != "shaft") return fmt::format(", every {:.3g} s,", leftover.period);
  return fmt::format(", {:.1f} times per turn,", 2.0 * std::numbers::pi / leftover.period);
}

// Where other variables do as well, none of them is certain.
std::string OthersText(const Leftover& leftover) {
  std::string text;
  for (const auto& other : leftover.one_of) {
    const std::string where = other.object == leftover.object ? "" : " of " + other.object;
    text += fmt::format("{}{}{}", text.empty() ? " or with one of these: " : ", ", other.variable,
                        where);
  }
  return text;
}

// With the verb for one thing or for many.
std::string WhatItDoes(const Leftover& leftover, bool many) {
  if (leftover.variable == diagnosis::kScatter) {
    return many ? "scatter beyond their stated noise" : "scatters beyond its stated noise";
  }
  if (leftover.variable == diagnosis::kAtRest) {
    return many ? "scatter where nothing moves" : "scatters where nothing moves";
  }
  if (leftover.variable == diagnosis::kMemory) {
    return fmt::format("{} correlated from one reading to the next", many ? "are" : "is");
  }
  if (leftover.IsOfAnInterval()) {
    const auto unit = simulation::UnitOf(leftover.variable);
    return fmt::format("{} offset where {} is {:.4g} to {:.4g} {},{}{}", many ? "are" : "is",
                       leftover.variable, leftover.from / unit.si, leftover.to / unit.si, unit.name,
                       OthersText(leftover), leftover.one_of.empty() ? "" : ",");
  }
  return fmt::format("{} with {}{}{}", many ? "vary" : "varies", leftover.variable,
                     PeriodText(leftover), OthersText(leftover));
}

std::string WhatFollows(const Leftover& leftover) {
  if (leftover.variable == diagnosis::kAtRest) {
    return "look for a bad contact, a loose mounting or a source of interference, or state the "
           "true noise in the machine file";
  }
  if (leftover.variable == diagnosis::kScatter) {
    return "no known cause explains it; look for what disturbs, or state the true noise in the "
           "machine file";
  }
  return "no known cause explains it";
}

bool AreAlike(const Leftover& one, const Leftover& other) {
  return WhatItDoes(one, true) == WhatItDoes(other, true) && one.unit.name == other.unit.name;
}

// "0.12 um", or from the least to the largest: "0.12 to 0.4 um".
std::string AmplitudesText(const std::vector<Leftover>& alike) {
  const auto [least, most] = std::ranges::minmax_element(alike, {}, &Leftover::amplitude);
  const auto& unit = alike.front().unit;
  const auto told = [&](const Leftover& one) {
    return fmt::format("{:.3g}", one.amplitude / unit.si);
  };
  const std::string range =
      told(*least) == told(*most) ? told(*most) : told(*least) + " to " + told(*most);
  return fmt::format("{} {}", range, unit.name);
}

// Each once, the largest first.
std::vector<std::string> ObjectsOf(std::vector<Leftover> alike) {
  std::ranges::stable_sort(alike, std::greater{}, &Leftover::amplitude);
  std::vector<std::string> objects;
  for (const Leftover& one : alike) {
    if (std::ranges::find(objects, one.object) == objects.end()) objects.push_back(one.object);
  }
  return objects;
}

// "probe_a, probe_b and probe_c", or the first `most` of them "and 4 more".
std::string ListText(const std::vector<std::string>& objects, std::size_t most) {
  const std::size_t shown = objects.size() > most + 1 ? most : objects.size();
  std::string text;
  for (std::size_t i = 0; i < shown; ++i) {
    const bool last = i + 1 == objects.size();
    if (i > 0) text += last ? " and " : ", ";
    text += objects[i];
  }
  if (shown < objects.size()) text += fmt::format(" and {} more", objects.size() - shown);
  return text;
}

// "p 3e-07", of several "p at most 3e-07"; below the smallest number it is no 0.
std::string ChanceOfLeft(double p_value, bool many) {
  constexpr double kSmallest = 1e-300;
  if (p_value < kSmallest) return "p below 1e-300";
  return fmt::format("p {}{:.1g}", many ? "at most " : "", p_value);
}

std::string LeftoverText(const std::vector<Leftover>& alike) {
  constexpr std::size_t kObjectsShown = 4;
  const std::vector<std::string> objects = ObjectsOf(alike);
  const double p_value = std::ranges::max(alike, {}, &Leftover::p_value).p_value;
  const std::string folded = objects.size() > kObjectsShown + 1 ? "; --verbose: each" : "";
  return fmt::format("\nUNEXPLAINED: {} {} by {} ({}{}); {}\n", ListText(objects, kObjectsShown),
                     WhatItDoes(alike.front(), objects.size() > 1), AmplitudesText(alike),
                     ChanceOfLeft(p_value, alike.size() > 1), folded, WhatFollows(alike.front()));
}

}  // namespace

std::string LeftoversText(const std::vector<Leftover>& leftovers, bool each) {
  std::vector<std::vector<Leftover>> groups;
  for (const Leftover& leftover : leftovers) {
    const auto alike = std::ranges::find_if(groups, [&](const std::vector<Leftover>& group) {
      return !each && AreAlike(group.front(), leftover);
    });
    if (alike == groups.end()) {
      groups.push_back({leftover});
    } else {
      alike->push_back(leftover);
    }
  }
  std::string text;
  for (const auto& group : groups) text += LeftoverText(group);
  return text;
}

}  // namespace abbe::apps
