#include "compensation/nc_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "failure/failure.h"

namespace abbe::compensation {
namespace {

constexpr int kLastOfProgram = 5000, kLastParameter = 5602;

bool IsGlobal(const std::string& name) { return name.starts_with('_'); }

}  // namespace

NcParameters::NcParameters(NcLive live, Stored stored)
    : live_(std::move(live)), unset_(stored ? 0.0 : kRuntime), levels_(1) {
  if (stored) numbers_.insert(stored->begin(), stored->end());
  levels_.front().arguments.fill(unset_);
}

double NcParameters::Number(int number) const {
  if (number < 1 || number > kLastParameter) {
    throw InputError(
        fmt::format("there is no parameter #{}; they go from #1 to #{}", number, kLastParameter));
  }
  if (number <= kArguments) return levels_.back().arguments[number - 1];
  if (number > kLastOfProgram) {
    const auto value = live_.number ? live_.number(number) : std::nullopt;
    return value.value_or(kRuntime);
  }
  const auto found = numbers_.find(number);
  return found == numbers_.end() ? unset_ : found->second;
}

void NcParameters::SetNumber(int number, double value) {
  if (number < 1 || number > kLastOfProgram) {
    throw InputError(
        fmt::format("sets #{}, which belongs to the control; set offsets with G10 or G92, others "
                    "from #1 to #{}",
                    number, kLastOfProgram));
  }
  if (number <= kArguments) {
    levels_.back().arguments[number - 1] = value;
  } else {
    numbers_[number] = value;
  }
}

std::optional<double> NcParameters::Named(const std::string& name) const {
  const auto& names = IsGlobal(name) ? names_ : levels_.back().names;
  const auto found = names.find(name);
  if (found != names.end()) return found->second;
  if (name == "_call_level") return static_cast<double>(level());
  if (name == "_remap_level") return 0.0;
  return IsGlobal(name) && live_.name ? live_.name(name) : std::nullopt;
}

double NcParameters::Exists(const std::string& name) const {
  const auto value = Named(name);
  const bool may_lack = name.starts_with("_hal[") || name.starts_with("_ini[");
  return may_lack && value && std::isnan(*value) ? kRuntime : value.has_value();
}

bool NcParameters::IsOfControl(const std::string& name) const {
  if (!IsGlobal(name) || names_.contains(name) || !live_.name) return false;
  const auto value = live_.name(name);
  return value && (std::isnan(*value) || name == "_task");  // 0 where a program is only drawn
}

bool NcParameters::IsOfSubroutine(const std::string& name, int number) {
  return name.empty() ? number <= kArguments : !IsGlobal(name);
}

// Whether a probe has touched; the last answer of M66.
bool NcParameters::IsOfControl(int number) {
  constexpr int kHasTouched = 5070, kInput = 5399;
  return number == kHasTouched || number == kInput;
}

void NcParameters::SetNamed(const std::string& name, double value) {
  (IsGlobal(name) ? names_ : levels_.back().names)[name] = value;
}

void NcParameters::Enter(const std::vector<double>& arguments) {
  Level level;
  level.arguments.fill(0.0);
  std::copy_n(arguments.begin(), std::min<std::size_t>(arguments.size(), kArguments),
              level.arguments.begin());
  levels_.push_back(std::move(level));
}

void NcParameters::Leave() { levels_.pop_back(); }

}  // namespace abbe::compensation
