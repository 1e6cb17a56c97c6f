#include "recording/recording.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <sstream>

namespace abbe::recording {

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
  toml::table table;
  try {
    table = toml::parse(header);
  } catch (const toml::parse_error& error) {
    throw InputError(fmt::format("{}: header line {}: not valid TOML: {}", name,
                                 error.source().begin.line, error.description()));
  }
  const toml::node_view<toml::node> found = table.at_path(path);
  if (!found) return std::nullopt;
  if (const auto text = found.value_exact<std::string>()) return text;
  std::ostringstream written;
  written << found;
  return written.str();
}

std::string Recording::Kind() const {
  if (auto kind = HeaderText("kind")) return *std::move(kind);
  throw InputError(
      fmt::format("{}: the header has no kind; say which, e.g. kind = \"sweep\"", name));
}

}  // namespace abbe::recording
