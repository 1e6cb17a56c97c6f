#include "simulation/doubt.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "failure/failure.h"

namespace abbe::simulation {

bool IsUnexplained(const ExtendedModel& model) {
  return model.verdict == kVerdictUnexplained || !model.unexplained.empty();
}

bool IsCertain(const ExtendedModel& model, const ModelledCause& cause) {
  return !IsUnexplained(model) && cause.probability >= kCertain;
}

double UnexplainedInSpace(const ExtendedModel& model) {
  double squares = 0.0;
  for (const Unexplained& left : model.unexplained) {
    if (!left.in_space) {
      throw InputError(fmt::format(
          "nobody knows by how much what is unexplained in {} ({}) moves a point, so no U95 can be "
          "stated; diagnose without that run, or go without --causes",
          left.object, left.variable));
    }
    squares += *left.in_space * *left.in_space;
  }
  return std::sqrt(squares);
}

void RefuseUnexplained(const ExtendedModel& model, const std::filesystem::path& file,
                       bool although) {
  if (!IsUnexplained(model) || although) return;
  const std::string left = UnexplainedText(model);
  const std::string runs = model.next_runs.empty()
                               ? "find what it is, measure again and diagnose again"
                               : fmt::format("make the runs \"{}\" and diagnose again",
                                             fmt::join(model.next_runs, "; "));
  throw InputError(fmt::format(
      "{}: its diagnosis left unexplained what no known cause makes{}, so none of its causes is "
      "certain; {}, or give --although-unexplained: then U95 is widened by it",
      file.string(), left.empty() ? "" : fmt::format(" ({})", left), runs));
}

double WithDoubt(double u, double change, double unexplained) {
  return std::hypot(u, change, unexplained);
}

std::string DoubtText(const ExtendedModel& model, const std::vector<ModelledCause>& causes) {
  std::vector<std::string> doubts;
  for (const ModelledCause& cause : causes) {
    if (IsCertain(model, cause)) continue;
    doubts.push_back(fmt::format("{} (probability {:.3f}{}{})", cause.Name(), cause.probability,
                                 cause.rivals.empty() ? "" : "; or ",
                                 fmt::join(cause.rivals, " or ")));
  }
  return doubts.empty() ? "" : fmt::format("not certain: {}", fmt::join(doubts, ", "));
}

std::string UnexplainedText(const ExtendedModel& model) {
  const auto& all = model.unexplained;
  const auto largest =
      std::max_element(all.begin(), all.end(), [](const Unexplained& a, const Unexplained& b) {
        return a.in_space.value_or(0.0) < b.in_space.value_or(0.0);
      });
  if (largest == all.end()) return "";
  return fmt::format("{} over {}, {:.3g} {}{}", largest->object, largest->variable,
                     largest->amplitude, largest->unit,
                     all.size() == 1 ? "" : fmt::format(", and {} more", all.size() - 1));
}

}  // namespace abbe::simulation
