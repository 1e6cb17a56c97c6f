#include "apps/plan_result.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "apps/diagnosis_result.h"

namespace abbe::apps {
namespace {

using diagnosis::Plan;
using diagnosis::PlannedCause;
using Eigen::Index;
using nlohmann::ordered_json;

// A key proportional to the size of the cause, in its own unit.
struct Size {
  std::string name;
  double plausible, seen;
};

std::vector<Size> SizesOf(const PlannedCause& planned) {
  std::vector<Size> sizes;
  if (!(planned.visible > 0.0)) return sizes;
  const auto [plausible, seen] = planned.sizes();
  for (Index i = 0; i < plausible.size(); ++i) {
    const auto& key = planned.candidate.cause->keys;
    if (i >= std::ssize(key) || std::isnan(plausible[i])) continue;
    const auto& [name, unit, least, most] = key[i];
    sizes.push_back({name, std::abs(plausible[i] / unit), std::abs(seen[i] / unit)});
  }
  return sizes;
}

std::string RowsOf(const PlannedCause& planned) {
  const std::string name = NameOf(planned.candidate);
  const std::vector<Size> sizes = SizesOf(planned);
  if (sizes.empty()) {
    return fmt::format("{:<38}{:<42}{:>10.1f} sd\n", name, "present or absent", planned.visible);
  }
  std::string rows;
  for (const Size& size : sizes) {
    rows += fmt::format("{:<38}{:<22}{:>10.3g}{:>10.3g}", rows.empty() ? name : "", size.name,
                        size.seen, size.plausible);
    rows += rows.find('\n') == std::string::npos ? fmt::format("{:>10.1f} sd\n", planned.visible)
                                                 : "\n";
  }
  return rows;
}

// A group of causes, each of which is similar to another one of the group.
struct ConfusedCauses {
  std::set<std::size_t> causes;
  double cosine = 1.0;  // the smallest of a similar pair
};

std::vector<ConfusedCauses> GroupsOf(const Plan& plan) {
  std::vector<ConfusedCauses> groups;
  for (const auto& [first, second, cosine] : plan.alike) {
    ConfusedCauses joined{{first, second}, cosine};
    std::erase_if(groups, [&](const ConfusedCauses& group) {
      const bool meets =
          std::any_of(joined.causes.begin(), joined.causes.end(),
                      [&](std::size_t cause) { return group.causes.contains(cause); });
      if (meets) {
        joined.causes.insert(group.causes.begin(), group.causes.end());
        joined.cosine = std::min(joined.cosine, group.cosine);
      }
      return meets;
    });
    groups.push_back(std::move(joined));
  }
  return groups;
}

}  // namespace

ordered_json PlanJson(const Plan& plan) {
  ordered_json json{{"command", "diagnose-plan"},
                    {"causes", ordered_json::array()},
                    {"cannot_show", ordered_json::array()},
                    {"alike", ordered_json::array()},
                    {"confused", ordered_json::array()}};
  for (const PlannedCause& planned : plan.causes) {
    ordered_json cause{{"cause", planned.candidate.cause->id},
                       {"object", planned.candidate.object.name()},
                       {"visible_sd", planned.visible},
                       {"seen", planned.seen()},
                       {"sizes", ordered_json::array()}};
    for (const Size& size : SizesOf(planned)) {
      ordered_json key = KeyJson(size.name);
      key.update({{"seen_from", size.seen}, {"plausible", size.plausible}});
      cause["sizes"].push_back(std::move(key));
    }
    json["causes"].push_back(std::move(cause));
    if (!planned.seen()) json["cannot_show"].push_back(planned.candidate.Name());
  }
  for (const std::string& name : plan.standing) json["cannot_show"].push_back(name);
  for (const auto& [first, second, cosine] : plan.alike) {
    json["alike"].push_back(
        {{"causes", {plan.causes[first].candidate.Name(), plan.causes[second].candidate.Name()}},
         {"cosine", cosine}});
  }
  for (const ConfusedCauses& group : GroupsOf(plan)) {
    std::vector<std::string> names;
    for (const std::size_t cause : group.causes) {
      names.push_back(plan.causes[cause].candidate.Name());
    }
    json["confused"].push_back({{"causes", names}, {"cosine", group.cosine}});
  }
  return json;
}

std::string PlanText(const Plan& plan) {
  std::string text = fmt::format("{:<38}{:<22}{:>10}{:>10}{:>13}\n", "would be seen", "size",
                                 "seen from", "usual", "usual is at");
  std::vector<std::string> hidden;
  for (const PlannedCause& planned : plan.causes) {
    if (planned.seen()) {
      text += RowsOf(planned);
    } else {
      hidden.push_back(fmt::format("{} ({:.1f} sd)", NameOf(planned.candidate), planned.visible));
    }
  }
  if (!hidden.empty()) {
    text += fmt::format("\nWould not be seen at their usual size: {}\n", fmt::join(hidden, ", "));
  }
  if (!plan.standing.empty()) {
    text += fmt::format("\nWould not be seen, because one of the two axes never moves: {}\n",
                        fmt::join(plan.standing, ", "));
  }
  for (const ConfusedCauses& group : GroupsOf(plan)) {
    std::vector<std::string> names;
    for (const std::size_t cause : group.causes) {
      names.push_back(NameOf(plan.causes[cause].candidate));
    }
    text += fmt::format("\nCannot be separated (cosine {:.3f}): {}\n", group.cosine,
                        fmt::join(names, ", "));
  }
  return text;
}

}  // namespace abbe::apps
