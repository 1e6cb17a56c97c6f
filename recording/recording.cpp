#include "recording/recording.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <cmath>
#include <sstream>

namespace abbe::recording {

namespace {

toml::table Parsed(const Recording& recording) {
  try {
    return toml::parse(recording.header);
  } catch (const toml::parse_error& error) {
    throw InputError(fmt::format("{}: header line {}: not valid TOML: {}", recording.name,
                                 error.source().begin.line, error.description()));
  }
}

std::string Written(const toml::node_view<const toml::node>& node) {
  std::ostringstream written;
  written << node;
  return written.str();
}

}  // namespace

std::optional<std::span<const double>> Recording::Find(std::string_view column) const {
  for (const Column& candidate : columns) {
    if (candidate.name == column) return std::span<const double>(candidate.values);
  }
  return std::nullopt;
}

std::span<const double> Recording::At(std::string_view column) const {
  if (const auto values = Find(column)) return *values;
  throw InputError(fmt::format("{}: {}: this column is missing; it is needed here", name, column));
}

std::optional<std::string> Recording::HeaderText(std::string_view path) const {
  const toml::table table = Parsed(*this);
  const toml::node_view<const toml::node> found = table.at_path(path);
  if (!found) return std::nullopt;
  if (const auto text = found.value_exact<std::string>()) return text;
  return Written(found);
}

std::optional<double> Recording::HeaderNumber(std::string_view path, double at_least) const {
  const toml::table table = Parsed(*this);
  const toml::node_view<const toml::node> found = table.at_path(path);
  if (!found) return std::nullopt;
  const std::optional<double> number = found.value<double>();
  if (number && std::isfinite(*number) && *number >= at_least) return number;
  throw InputError(fmt::format(
      "{}: header: {} is {}; write a number{}", name, path, Written(found),
      std::isfinite(at_least) ? fmt::format(" of at least {:g}", at_least) : std::string()));
}

std::optional<std::vector<double>> Recording::HeaderNumbers(std::string_view path,
                                                            std::size_t count) const {
  const toml::table table = Parsed(*this);
  const toml::node_view<const toml::node> found = table.at_path(path);
  if (!found) return std::nullopt;
  std::vector<double> numbers;
  if (const toml::array* array = found.as_array()) {
    for (const toml::node& node : *array) {
      const std::optional<double> number = node.value<double>();
      if (number && std::isfinite(*number)) numbers.push_back(*number);
    }
    if (numbers.size() == count && array->size() == count) return numbers;
  }
  throw InputError(fmt::format("{}: header: {} is {}; write {} numbers in brackets", name, path,
                               Written(found), count));
}

std::string Recording::Kind() const {
  if (auto kind = HeaderText("kind")) return *std::move(kind);
  throw InputError(
      fmt::format("{}: the header has no kind; say which, e.g. kind = \"sweep\"", name));
}

bool Recording::KnowsTimes() const {
  return Find("time_s") && HeaderText("time").value_or("") != "order";
}

bool Recording::IsSimulated() const {
  return HeaderText("simulated") == "true" || HeaderText("rig").has_value();
}

}  // namespace abbe::recording
