#include "recording/instant.h"

#include <chrono>
#include <cmath>
#include <ctime>
#include <iomanip>
#include <sstream>
#include <string_view>

namespace abbe::recording {
namespace {

constexpr const char* kForm = "%Y-%m-%dT%H:%M:%S";
constexpr double kMinute = 60.0;  // s
constexpr double kHour = 60.0 * kMinute;
constexpr double kDay = 24.0 * kHour;

// Reads numbers of a fixed count of digits from the front of a text.
class Digits {
 public:
  explicit Digits(std::string_view text) : rest_(text) {}

  std::string_view rest() const { return rest_; }
  bool is_right() const { return is_right_; }

  int Number(std::size_t digits) {
    int number = 0;
    for (std::size_t i = 0; i < digits; ++i) {
      const bool is_digit = i < rest_.size() && rest_[i] >= '0' && rest_[i] <= '9';
      if (!is_digit) {
        is_right_ = false;
        return 0;
      }
      number = 10 * number + (rest_[i] - '0');
    }
    rest_.remove_prefix(digits);
    return number;
  }

  // The next character is one of these.
  void Mark(std::string_view any) {
    is_right_ = is_right_ && !rest_.empty() && any.find(rest_.front()) != std::string_view::npos;
    if (is_right_) rest_.remove_prefix(1);
  }

  // ".25", or nothing.
  double Fraction() {
    if (!rest_.starts_with('.')) return 0.0;
    double fraction = 0.0, place = 0.1;
    Mark(".");
    do {
      fraction += place * Number(1);
      place /= 10.0;
    } while (is_right_ && !rest_.empty() && rest_.front() >= '0' && rest_.front() <= '9');
    return fraction;
  }

 private:
  std::string_view rest_;
  bool is_right_ = true;
};

// Seconds by which the clock of the zone is ahead of UTC; nothing for what is no zone.
std::optional<double> AheadOfUtc(std::string_view zone) {
  if (zone.empty() || zone == "Z" || zone == "z") return 0.0;
  const double sign = zone.front() == '-' ? -1.0 : 1.0;
  Digits digits(zone);
  digits.Mark("+-");
  const int hours = digits.Number(2);
  digits.Mark(":");
  const int minutes = digits.Number(2);
  if (!digits.is_right() || !digits.rest().empty() || hours > 23 || minutes > 59) {
    return std::nullopt;
  }
  return sign * (hours * kHour + minutes * kMinute);
}

}  // namespace

std::optional<double> SecondsOf(const std::string& instant) {
  Digits digits(instant);
  const int year = digits.Number(4);
  digits.Mark("-");
  const int month = digits.Number(2);
  digits.Mark("-");
  const int day = digits.Number(2);
  int hour = 0, minute = 0;
  double second = 0.0;
  if (!digits.rest().empty()) {
    digits.Mark("Tt ");
    hour = digits.Number(2);
    digits.Mark(":");
    minute = digits.Number(2);
    digits.Mark(":");
    second = digits.Number(2) + digits.Fraction();
  }
  const std::chrono::year_month_day date{std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(month)),
                                         std::chrono::day(static_cast<unsigned>(day))};
  if (!digits.is_right() || !date.ok() || hour > 23 || minute > 59 || second >= kMinute) {
    return std::nullopt;
  }
  const auto ahead = AheadOfUtc(digits.rest());
  if (!ahead) return std::nullopt;
  const auto days = std::chrono::sys_days(date).time_since_epoch().count();
  return static_cast<double>(days) * kDay + hour * kHour + minute * kMinute + second - *ahead;
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
