#include "relm/error_model_name.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>

#include "failure/failure.h"

namespace abbe::relm {
namespace {

// In the order of ErrorModel.
constexpr std::array<std::string_view, 4> kErrorModelNames{"pivots", "published",
                                                           "published-with-bearing", "complete"};

}  // namespace

std::string ErrorModelName(ErrorModel model) {
  return std::string(kErrorModelNames.at(static_cast<std::size_t>(model)));
}

ErrorModel ErrorModelNamed(std::string name) {
  const std::string text = name;
  std::ranges::replace(name, ' ', '-');
  const auto found = std::ranges::find(kErrorModelNames, name);
  if (found == kErrorModelNames.end()) {
    throw InputError(fmt::format("\"{}\" is no error model of the linkage; write one of {}", text,
                                 ErrorModelNames()));
  }
  return static_cast<ErrorModel>(found - kErrorModelNames.begin());
}

std::string ErrorModelNames() { return fmt::format("{}", fmt::join(kErrorModelNames, ", ")); }

}  // namespace abbe::relm
