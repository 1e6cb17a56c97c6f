#include "recording/instant.h"

#include <cmath>
#include <ctime>
#include <iomanip>
#include <sstream>

namespace abbe::recording {
namespace {

constexpr const char* kForm = "%Y-%m-%dT%H:%M:%S";

}  // namespace

std::optional<double> SecondsOf(const std::string& instant) {
  std::tm calendar{};
  std::istringstream stream(instant);
  stream >> std::get_time(&calendar, kForm);
  if (stream.fail()) return std::nullopt;
  return static_cast<double>(timegm(&calendar));
}

std::string InstantText(double seconds) {
  const auto whole = static_cast<std::time_t>(std::llround(seconds));
  std::tm calendar{};
  gmtime_r(&whole, &calendar);
  std::ostringstream stream;
  stream << std::put_time(&calendar, kForm) << 'Z';
  return stream.str();
}

std::string UtcNow() { return InstantText(std::time(nullptr)); }

}  // namespace abbe::recording
