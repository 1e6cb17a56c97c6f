#include "recording/check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "settings/nearest_word.h"
#include "settings/toml_text.h"

namespace abbe::recording {
namespace {

constexpr double kAllFlags = kStale | kOutOfRange | kDeviceError | kInterpolated | kClockJump;

// One of the names of each inner list is required.
using Required = std::vector<std::vector<std::string>>;

struct KindRule {
  std::string_view kind;
  Required required;
};

const std::vector<KindRule>& KindRules() {
  static const Required kProbes{{"time_s"},     {"x_mm"},       {"y_mm"},       {"z_mm"},
                                {"pass"},       {"direction"},  {"probe_a_um"}, {"probe_b_um"},
                                {"probe_c_um"}, {"probe_d_um"}, {"probe_e_um"}};
  static const std::vector<KindRule> rules{
      {"sweep", kProbes},
      {"gap-steps", kProbes},
      {"linkage",
       {{"time_s", "ref_x_mm"},  // poses before an instrument may be in no order
        {"x_mm", "ref_x_mm"},
        {"y_mm", "ref_y_mm"},
        {"z_mm", "ref_z_mm"},
        {"pivot_1_rad"}}},
      {"reference", {{"x_mm", "y_mm", "z_mm"}, {"ref_x_mm", "ref_y_mm", "ref_z_mm"}}},
      {"ballbar", {{"x_mm", "y_mm"}, {"y_mm", "z_mm"}, {"x_mm", "z_mm"}, {"ref_radius_mm"}}},
      {"length", {{"x_mm"}, {"y_mm"}, {"z_mm"}, {"length_mm"}}},
      {"plate",
       {{"x_mm"}, {"y_mm"}, {"z_mm"}, {"setup"}, {"hole"}, {"plate_x_mm"}, {"plate_y_mm"}}},
      {"shaft", {{"time_s"}, {"shaft_deg", "shaft_rad"}}},
      {"dwell", {{"time_s"}}},
  };
  return rules;
}

// Allowed values of a column that abbe knows, besides finite.
struct ValueRule {
  std::string_view begin, end;  // of the column's name; both are the whole name for a single column
  bool (*allows)(double);
  std::string_view wanted;
};

bool Any(double) { return true; }
bool NotNegative(double value) { return value >= 0.0; }
bool Count(double value) { return value >= 0.0 && value == std::floor(value); }
bool Sign(double value) { return value == -1.0 || value == 0.0 || value == 1.0; }

constexpr std::array<ValueRule, 19> kValueRules{{
    {"x_mm", "x_mm", Any, ""},
    {"y_mm", "y_mm", Any, ""},
    {"z_mm", "z_mm", Any, ""},
    {"pass", "pass", Count, "a whole number from 0"},
    {"direction", "direction", Sign, "-1, 0 or 1"},
    {"approach_x", "approach_x", Sign, "-1, 0 or 1"},
    {"approach_y", "approach_y", Sign, "-1, 0 or 1"},
    {"approach_z", "approach_z", Sign, "-1, 0 or 1"},
    {"feed_mm_min", "feed_mm_min", NotNegative, "0 or above"},
    {"probe_", "_um", NotNegative, "a gap, 0 or above"},
    {"pivot_", "_rad", Any, ""},
    {"cap_force_n", "cap_force_n", Any, ""},
    {"ref_", "_mm", Any, ""},
    {"length_mm", "length_mm", NotNegative, "0 or above"},
    {"u_", "_um", NotNegative, "0 or above"},
    {"setup", "setup", Count, "a whole number from 0"},
    {"hole", "hole", Count, "a whole number from 0"},
    {"plate_", "_mm", Any, ""},
    {"temp_", "_c", Any, ""},
}};

const ValueRule* RuleOf(std::string_view name) {
  for (const ValueRule& rule : kValueRules) {
    const bool whole = rule.begin == rule.end;
    if (whole ? name == rule.begin : name.starts_with(rule.begin) && name.ends_with(rule.end)) {
      return &rule;
    }
  }
  return nullptr;
}

[[noreturn]] void Refuse(std::string_view place, std::string_view what, std::string_view message) {
  throw InputError(fmt::format("{}: {}: {}", place, what, message));
}

// `before`: in, the time of the row before the block; out, that of its last row.
void CheckTime(std::span<const double> time, std::size_t first_row, const Places& places,
               double& before) {
  for (std::size_t i = 0; i < time.size(); ++i) {
    if (!std::isfinite(time[i])) {
      Refuse(places.Row(first_row + i), "time_s",
             fmt::format("is {}; every row needs a time", time[i]));
    }
    if (time[i] < before) {
      Refuse(places.Row(first_row + i), "time_s",
             fmt::format("goes back from {} to {}; rows must be in the order of time", before,
                         time[i]));
    }
    before = time[i];
  }
}

void CheckFlags(std::span<const double> flags, std::size_t first_row, const Places& places) {
  for (std::size_t i = 0; i < flags.size(); ++i) {
    if (!Count(flags[i]) || flags[i] > kAllFlags) {
      Refuse(places.Row(first_row + i), "flags",
             fmt::format("is {}; it must be a sum of 1 stale, 2 out of range, 4 device error, 8 "
                         "interpolated, 16 clock jump, or 0",
                         flags[i]));
    }
  }
}

void CheckValues(const Column& column, const ValueRule& rule, std::span<const double> flags,
                 std::size_t first_row, const Places& places) {
  for (std::size_t i = 0; i < column.values.size(); ++i) {
    const double value = column.values[i];
    if (std::isfinite(value) && rule.allows(value)) continue;
    if (!flags.empty() && flags[i] != 0.0) continue;
    if (std::isfinite(value)) {
      Refuse(places.Row(first_row + i), column.name,
             fmt::format("is {}; it must be {}, or the row must carry a flag", value, rule.wanted));
    }
    Refuse(places.Row(first_row + i), column.name,
           fmt::format("is {} in a row without a flag; say in the column flags why the value is "
                       "missing, or remove the row",
                       value));
  }
}

}  // namespace

std::string Places::Header(std::size_t line) const {
  return header_line > 0 ? fmt::format("{}:{}", file, header_line + line - 1)
                         : fmt::format("{}: header line {}", file, line);
}

std::string Places::Row(std::size_t row) const {
  return first_row_line > 0 ? fmt::format("{}:{}", file, first_row_line + row)
                            : fmt::format("{}: row {}", file, row + 1);
}

void CheckColumnNames(const std::vector<std::string>& names, std::string_view place) {
  if (names.empty()) throw InputError(fmt::format("{}: a recording needs a column", place));
  std::set<std::string_view> seen;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string& name = names[i];
    if (name.empty()) {
      throw InputError(fmt::format("{}: column {} has no name; give it one", place, i + 1));
    }
    const bool control = std::any_of(name.begin(), name.end(),
                                     [](char c) { return c >= 0 && (c < 32 || c == 127); });
    if (control || name.find_first_of(",;\"/") != std::string::npos || name.front() == '#' ||
        name.front() == ' ' || name.back() == ' ' || name == ".") {
      throw InputError(fmt::format("{}: column {} is named `{}`; use letters, digits and _ only",
                                   place, i + 1, control ? std::string("?") : name));
    }
    if (!settings::IsUtf8(name)) {
      throw InputError(fmt::format(
          "{}: the name of column {} is not UTF-8; save the file as UTF-8, or name it in letters",
          place, i + 1));
    }
    if (!seen.insert(name).second) {
      Refuse(place, name, "two columns have this name; rename one");
    }
  }
}

std::vector<std::string_view> KnownKinds() {
  std::vector<std::string_view> kinds;
  for (const KindRule& rule : KindRules()) kinds.push_back(rule.kind);
  return kinds;
}

std::vector<std::string> RequiredColumns(std::string_view kind) {
  std::vector<std::string> columns;
  for (const KindRule& rule : KindRules()) {
    if (rule.kind != kind) continue;
    for (const auto& names : rule.required) columns.push_back(names.front());
  }
  return columns;
}

void CheckHeader(const std::string& header, const std::vector<std::string>& names,
                 const Places& places) {
  toml::table table;
  try {
    table = toml::parse(header);
  } catch (const toml::parse_error& error) {
    throw InputError(fmt::format("{}: the header is not valid TOML: {}",
                                 places.Header(error.source().begin.line), error.description()));
  }
  std::vector<std::string> kinds;
  for (const KindRule& rule : KindRules()) kinds.emplace_back(rule.kind);
  const toml::node* node = table.get("kind");
  if (node == nullptr) {
    Refuse(places.Header(1), "kind",
           fmt::format("is missing; it must be one of: {}", fmt::join(kinds, ", ")));
  }
  const std::string kind = node->value_or(std::string{});
  const auto rule = std::find_if(KindRules().begin(), KindRules().end(),
                                 [&](const KindRule& candidate) { return candidate.kind == kind; });
  if (rule == KindRules().end()) {
    Refuse(places.Header(node->source().begin.line), "kind",
           fmt::format("\"{}\" is not a kind of recording; did you mean \"{}\"? ({})", kind,
                       settings::NearestWord(kind, kinds), fmt::join(kinds, ", ")));
  }
  const std::string place = places.first_row_line > 0
                                ? fmt::format("{}:{}", places.file, places.first_row_line - 1)
                                : places.file;
  for (const std::vector<std::string>& any : rule->required) {
    const bool found = std::any_of(any.begin(), any.end(), [&](const std::string& name) {
      return std::find(names.begin(), names.end(), name) != names.end();
    });
    if (!found) {
      Refuse(place, fmt::format("{}", fmt::join(any, " or ")),
             fmt::format("is missing; a {} recording needs this column", kind));
    }
  }
}

void RowCheck::Take(const Recording& block) {
  for (const Column& column : block.columns) {
    if (column.values.size() != block.rows()) {
      Refuse(places_.file, column.name,
             fmt::format("has {} rows, but {} has {}; all columns must be of one length",
                         column.values.size(), block.columns.front().name, block.rows()));
    }
  }
  if (const auto time = block.Find("time_s")) CheckTime(*time, block.first_row, places_, time_);
  const std::span<const double> flags = block.Find("flags").value_or(std::span<const double>{});
  CheckFlags(flags, block.first_row, places_);
  for (const Column& column : block.columns) {
    const ValueRule* rule = RuleOf(column.name);
    if (rule != nullptr) CheckValues(column, *rule, flags, block.first_row, places_);
  }
}

void Check(const Recording& recording, const Places& places) {
  std::vector<std::string> names;
  for (const Column& column : recording.columns) names.push_back(column.name);
  CheckColumnNames(names, places.file);
  CheckHeader(recording.header, names, places);
  RowCheck(places).Take(recording);
}

}  // namespace abbe::recording
