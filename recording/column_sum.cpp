#include "recording/column_sum.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "failure/failure.h"
#include "settings/column_name.h"
#include "settings/unit.h"

namespace abbe::recording {
namespace {

class SumParser {
 public:
  SumParser(std::string_view text, std::string_view new_name, const std::vector<std::string>& names,
            const std::string& place)
      : whole_(text),
        rest_(text),
        unit_(settings::UnitOf(new_name)),
        names_(names),
        place_(place) {}

  ColumnSum Parse() {
    if (IsName(whole_)) {
      const std::size_t column = ColumnNamed(whole_);
      sum_.terms.push_back({column, FactorOf(whole_)});
      return std::move(sum_);
    }
    double sign = TakeAny("+-") == '-' ? -1.0 : 1.0;
    for (;;) {
      TakeTerm(sign);
      const char next = TakeAny("+-");
      if (next == 0) break;
      sign = next == '-' ? -1.0 : 1.0;
    }
    if (!Blank()) Refuse("is not a sum of columns and numbers");
    if (sum_.terms.empty()) Refuse("names no column");
    return std::move(sum_);
  }

 private:
  // Numbers and at most one column, joined by * and /.
  void TakeTerm(double factor) {
    std::optional<std::size_t> column;
    bool divides = false;
    for (;;) {
      if (const auto number = TakeNumber()) {
        factor = divides ? factor / *number : factor * *number;
      } else {
        if (column || divides) Refuse("multiplies or divides by a column");
        const std::string name = TakeName();
        column = ColumnNamed(name);
        factor *= FactorOf(name);
      }
      const char next = TakeAny("*/");
      if (next == 0) break;
      divides = next == '/';
    }
    if (!std::isfinite(factor)) Refuse("divides by 0, or has a number out of range");
    if (column) {
      sum_.terms.push_back({*column, factor});
    } else {
      sum_.offset += factor;
    }
  }

  // The name in quotes, or the longest name of the table that matches here.
  std::string TakeName() {
    if (Blank()) Refuse("ends where a column or a number is missing");
    if (rest_.front() == '"') {
      const auto end = rest_.find('"', 1);
      if (end == std::string_view::npos) Refuse("has no closing quote");
      std::string name(rest_.substr(1, end - 1));
      rest_.remove_prefix(end + 1);
      return name;
    }
    std::string_view longest;
    for (const std::string& name : names_) {
      if (name.size() > longest.size() && rest_.starts_with(name) && EndsAt(name.size())) {
        longest = name;
      }
    }
    // An unknown name: the whole word, for the message.
    std::string name(longest.empty() ? rest_.substr(0, rest_.find_first_of(" \t+-*/")) : longest);
    rest_.remove_prefix(name.size());
    return name;
  }

  std::optional<double> TakeNumber() {
    if (Blank()) return {};
    double value = 0.0;
    const auto [stop, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value);
    const std::size_t size = stop - rest_.data();
    const char first = rest_.front();
    const bool digit = (first >= '0' && first <= '9') || first == '.';
    if (error != std::errc{} || !digit || !EndsAt(size)) return {};
    rest_.remove_prefix(size);
    return value;
  }

  bool EndsAt(std::size_t size) const {
    return size == rest_.size() ||
           std::string_view(" \t+-*/").find(rest_[size]) != std::string_view::npos;
  }

  bool Blank() {
    const auto first = rest_.find_first_not_of(" \t");
    rest_.remove_prefix(std::min(first, rest_.size()));
    return rest_.empty();
  }

  // Takes the next letter if it is one of `letters`; else returns 0.
  char TakeAny(std::string_view letters) {
    if (Blank() || letters.find(rest_.front()) == std::string_view::npos) return 0;
    const char letter = rest_.front();
    rest_.remove_prefix(1);
    return letter;
  }

  bool IsName(std::string_view text) const {
    return std::find(names_.begin(), names_.end(), text) != names_.end();
  }

  std::size_t ColumnNamed(std::string_view name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end()) {
      throw InputError(fmt::format("{}: has no column \"{}\"; it has {}", place_, name,
                                   fmt::join(names_, ", ")));
    }
    if (std::find(found + 1, names_.end(), name) != names_.end()) {
      throw InputError(
          fmt::format("{}: has two columns \"{}\"; rename one in the table", place_, name));
    }
    return found - names_.begin();
  }

  double FactorOf(std::string_view column) {
    const settings::Unit was = settings::ColumnNameOf(column).unit;
    if (was.name.empty() || unit_.name.empty()) return 1.0;
    if (settings::MeasureTheSame(was, unit_)) return was.si / unit_.si;
    // One letter ends many a name that has no unit: probe_c.
    const bool letter = column.size() > 1 && column[column.size() - 2] == '_';
    if (!letter) {
      throw InputError(fmt::format(
          "{}: the column \"{}\" is in {}, which is no unit of what is wanted in {}; give another "
          "column, or rename it",
          place_, column, was.name, unit_.name));
    }
    sum_.notes.push_back(
        fmt::format("{}: the column \"{}\" is taken as it is, in {}", place_, column, unit_.name));
    return 1.0;
  }

  [[noreturn]] void Refuse(std::string_view why) const {
    throw InputError(fmt::format("{}: the column \"{}\" {}; write for example counts*0.00549+3",
                                 place_, whole_, why));
  }

  std::string_view whole_, rest_;
  settings::Unit unit_;
  const std::vector<std::string>& names_;
  const std::string& place_;
  ColumnSum sum_;
};

}  // namespace

double ColumnSum::Of(const std::vector<double>& cells) const {
  double value = offset;
  for (const Term& term : terms) value += term.factor * cells[term.column];
  return value;
}

ColumnSum ParseColumnSum(std::string_view text, std::string_view new_name,
                         const std::vector<std::string>& names, const std::string& place) {
  return SumParser(text, new_name, names, place).Parse();
}

}  // namespace abbe::recording
