#include "settings/toml_keys.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "failure/failure.h"
#include "settings/document.h"
#include "settings/nearest_word.h"
#include "settings/toml_text.h"

namespace abbe::settings {
namespace {

toml::table Parsed(const std::string& text) { return toml::parse(text); }

void NamesBelow(const toml::node& node, const std::string& path, std::vector<std::string>& names) {
  if (const auto* table = node.as_table()) {
    for (const auto& [key, value] : *table) {
      NamesBelow(value,
                 path.empty() ? std::string(key.str()) : fmt::format("{}.{}", path, key.str()),
                 names);
    }
    return;
  }
  const auto* array = node.as_array();
  if (array == nullptr || array->empty() || !array->front().is_table()) {
    names.push_back(path);
    return;
  }
  for (std::size_t i = 0; i < array->size(); ++i) {
    NamesBelow(*array->get(i), fmt::format("{}[{}]", path, i), names);
  }
}

// Empty where the elements are not all of that type.
template <typename Value>
std::optional<TomlValue> ListOf(const toml::array& array) {
  std::vector<Value> values;
  for (const toml::node& element : array) {
    const auto value = element.value<Value>();
    if (!value) return {};
    values.push_back(*value);
  }
  return values;
}

std::optional<TomlValue> ValueOf(const toml::node& node) {
  if (const auto* truth = node.as_boolean()) return truth->get();
  if (const auto* whole = node.as_integer()) return whole->get();
  if (const auto* number = node.as_floating_point()) return number->get();
  if (const auto* text = node.as_string()) return text->get();
  const auto* array = node.as_array();
  if (array == nullptr) return {};
  if (const auto numbers = ListOf<double>(*array)) return numbers;
  return ListOf<std::string>(*array);
}

struct TextOf {
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(std::int64_t value) const { return fmt::format("{}", value); }
  std::string operator()(double value) const { return Float(value); }
  std::string operator()(const std::string& value) const { return Quoted(value); }
  std::string operator()(const std::vector<double>& values) const { return Floats(values); }
  std::string operator()(const std::vector<std::string>& values) const {
    return QuotedList(values);
  }
};

bool IsFinite(const TomlValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return std::isfinite(*number);
  const auto* numbers = std::get_if<std::vector<double>>(&value);
  return numbers == nullptr ||
         std::ranges::all_of(*numbers, [](double each) { return std::isfinite(each); });
}

// Where a line and a column of TOML++ are in the text: columns count characters of UTF-8.
std::size_t PlaceOf(const std::string& text, const toml::source_position& position) {
  std::size_t at = 0;
  for (toml::source_index line = 1; line < position.line && at < text.size(); ++line) {
    at = std::min(text.find('\n', at), text.size() - 1) + 1;
  }
  const auto goes_on = [&] {
    return at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
  };
  for (toml::source_index column = 1; column < position.column && at < text.size(); ++column) {
    do {
      ++at;
    } while (goes_on());
  }
  return at;
}

std::size_t EndOfLine(const std::string& text, std::size_t at) {
  return std::min(text.find('\n', at), text.size());
}

// "axis.X", "last_mm"; the table is empty at the top.
std::pair<std::string, std::string> TableAndKey(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  if (dot == std::string_view::npos) return {"", std::string(path)};
  return {std::string(path.substr(0, dot)), std::string(path.substr(dot + 1))};
}

const toml::table* TableAt(const toml::table& root, const std::string& path) {
  return path.empty() ? &root : toml::at_path(root, path).as_table();
}

// Behind the last value of the table at the top.
std::size_t EndOfTop(const std::string& text, const toml::table& root) {
  std::size_t end = 0;
  for (const auto& [key, value] : root) {
    if (value.is_table() || value.is_array_of_tables()) continue;
    end = std::max(end, EndOfLine(text, PlaceOf(text, value.source().end)) + 1);
  }
  return std::min(end, text.size());
}

// Texts in which the key has the value, where it is written as usual.
std::vector<std::string> Attempts(const std::string& text, const toml::table& root,
                                  std::string_view path, const std::string& value) {
  if (const toml::node* node = toml::at_path(root, path).node()) {
    const std::size_t begin = PlaceOf(text, node->source().begin),
                      end = PlaceOf(text, node->source().end);
    return {text.substr(0, begin) + value + text.substr(end)};
  }
  const auto [table, key] = TableAndKey(path);
  const std::string line = fmt::format("{} = {}\n", Key(key), value);
  const std::string ended = text.empty() || text.ends_with('\n') ? text : text + "\n";
  const std::string added = fmt::format("{}\n[{}]\n{}", ended, table, line);
  const toml::table* in = TableAt(root, table);
  if (in == nullptr) return {added};
  const std::size_t at = table.empty() ? EndOfTop(ended, root)
                                       : EndOfLine(ended, PlaceOf(ended, in->source().begin)) + 1;
  return {ended.substr(0, at) + line + ended.substr(std::min(at, ended.size())), added};
}

// Whether `text` is `before` with that key alone changed.
bool Has(const std::string& text, toml::table before, std::string_view path,
         const std::string& value) {
  try {
    toml::table after = Parsed(text);
    toml::table wanted = Parsed("value = " + value), found;
    const auto [table, key] = TableAndKey(path);
    const toml::node* node = toml::at_path(after, path).node();
    if (node == nullptr) return false;
    found.insert_or_assign("value", toml::node_view<const toml::node>(*node));
    if (found != wanted) return false;
    const auto without = [&, table = table, key = key](toml::table& all) {
      toml::table* in = table.empty() ? &all : toml::at_path(all, table).as_table();
      if (in != nullptr) in->erase(key);
      return in != nullptr;
    };
    const bool had_table = without(before);
    without(after);
    return !had_table || before == after;
  } catch (const toml::parse_error&) {
    return false;
  }
}

}  // namespace

TomlKeys::TomlKeys(std::string text, std::string name)
    : text_(std::move(text)), name_(std::move(name)) {
  Document::Parse(text_, name_);
}

std::vector<std::string> TomlKeys::Names() const {
  std::vector<std::string> names;
  NamesBelow(Parsed(text_), "", names);
  return names;
}

TomlValue TomlKeys::Value(std::string_view key) const {
  const toml::table root = Parsed(text_);
  const toml::node* node = toml::at_path(root, key).node();
  if (node == nullptr) {
    throw InputError(fmt::format("{}: {}: is not there; did you mean {}?", name_, key,
                                 NearestWord(key, Names())));
  }
  if (auto value = ValueOf(*node)) return *std::move(value);
  throw InputError(
      fmt::format("{}: {}: is no value but a table or a list of several kinds; name a "
                  "key below it",
                  name_, key));
}

TomlKeys TomlKeys::With(std::string_view key, const TomlValue& value) const {
  if (!IsFinite(value)) {
    throw InputError(fmt::format("{}: {}: must be a finite number", name_, key));
  }
  const toml::table root = Parsed(text_);
  const std::string written = std::visit(TextOf{}, value);
  for (std::string& text : Attempts(text_, root, key, written)) {
    if (Has(text, root, key, written)) return {std::move(text), name_};
  }
  throw InputError(
      fmt::format("{}: {}: cannot be changed, because it is a table or its table has no header of "
                  "its own; change it in the file",
                  name_, key));
}

}  // namespace abbe::settings
