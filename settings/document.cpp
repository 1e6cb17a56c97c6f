#include "settings/document.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <set>
#include <sstream>

#include "settings/nearest_word.h"
#include "settings/unit.h"

namespace abbe::settings {

struct Document::State {
  std::string name;
  toml::table root;
  std::map<std::string, RequestedKey> requested;
  // Real table path -> keys requested by name, and keys returned by Named().
  std::map<std::string, std::set<std::string, std::less<>>> known;
  std::map<std::string, std::set<std::string, std::less<>>> named;
};

struct Table::Node {
  const toml::table* table = nullptr;  // null: the table is absent
  std::size_t line = 0;
};

namespace {

std::string Join(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : fmt::format("{}.{}", path, key);
}

const toml::node* Find(const toml::table* table, std::string_view key) {
  return table == nullptr ? nullptr : table->get(key);
}

// An integer of any size is accepted as a number.
double AsNumber(const toml::node& node) {
  if (const auto* whole = node.as_integer()) return whole->get();
  return node.as_floating_point()->get();
}

// Text quoted from a file may contain line ends; a message is one line.
std::string OneLine(std::string text) {
  for (char& letter : text) {
    if (static_cast<unsigned char>(letter) < ' ' || letter == '\x7f') letter = ' ';
  }
  return text;
}

std::string WithUnit(double value, const Unit& unit) {
  return unit.name.empty() ? fmt::format("{}", value) : fmt::format("{} {}", value, unit.name);
}

}  // namespace

Document::Document(std::shared_ptr<State> state) : state_(std::move(state)) {}

Document Document::Read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path)) {
    throw InputError(
        fmt::format("{}: cannot be read: {}; check the path", path.string(),
                    std::filesystem::is_directory(path) ? "it is a folder" : std::strerror(errno)));
  }
  std::ostringstream text;
  text << file.rdbuf();
  const std::string_view begin = text.view();
  if (begin.starts_with("\x89HDF") || begin.starts_with("# abbe-recording") ||
      begin.starts_with("#abbe-recording")) {
    throw InputError(fmt::format(
        "{}: is a recording or another table, not a file of settings (TOML); are two arguments "
        "swapped?",
        path.string()));
  }
  return Parse(text.str(), path.string());
}

Document Document::Parse(std::string_view text, std::string name) {
  auto state = std::make_shared<State>();
  state->name = std::move(name);
  try {
    state->root = toml::parse(text, state->name);
  } catch (const toml::parse_error& error) {
    throw InputError(OneLine(fmt::format("{}:{}: not valid TOML: {}", state->name,
                                         error.source().begin.line, error.description())));
  }
  return Document(std::move(state));
}

Table Document::Root() const {
  return Table(state_, std::make_shared<Table::Node>(Table::Node{&state_->root, 1}), "", "", "");
}

const std::string& Document::name() const { return state_->name; }
const std::map<std::string, RequestedKey>& Document::requested() const { return state_->requested; }

Table::Table(std::shared_ptr<Document::State> state, std::shared_ptr<const Node> node,
             std::string path, std::string requested_path, std::string key)
    : state_(std::move(state)),
      node_(std::move(node)),
      path_(std::move(path)),
      requested_path_(std::move(requested_path)),
      key_(std::move(key)) {}

void Table::Request(std::string_view key, const RequestedKey& requested) const {
  state_->known[path_].emplace(key);
  state_->requested.try_emplace(Join(requested_path_, key), requested);
}

InputError Table::Error(std::string_view key, std::string_view message) const {
  const toml::node* node = key.empty() ? nullptr : Find(node_->table, key);
  const std::size_t line = node != nullptr ? node->source().begin.line : node_->line;
  const std::string place = line > 0 ? fmt::format("{}:{}", state_->name, line) : state_->name;
  const std::string path = key.empty() ? path_ : Join(path_, key);
  return InputError(OneLine(path.empty() ? fmt::format("{}: {}", place, message)
                                         : fmt::format("{}: {}: {}", place, path, message)));
}

bool Table::Has(std::string_view key) const { return Find(node_->table, key) != nullptr; }

std::string Table::Text(std::string_view key) const {
  Request(key, {"text", "", ""});
  const toml::node* node = Find(node_->table, key);
  if (node == nullptr) throw Error(key, "is missing; it must be a text in quotes");
  if (!node->is_string()) throw Error(key, "must be a text in quotes");
  return node->value<std::string>().value();
}

std::string Table::Text(std::string_view key, std::string_view fallback) const {
  Request(key, {"text", "", fmt::format("\"{}\"", fallback)});
  return Has(key) ? Text(key) : std::string(fallback);
}

std::string Table::Choice(std::string_view key, const std::vector<std::string>& allowed,
                          bool required) const {
  if (!required) Request(key, {"text", "", fmt::format("\"{}\"", allowed.front())});
  if (!required && !Has(key)) return allowed.front();
  std::string value = Text(key);
  if (std::find(allowed.begin(), allowed.end(), value) == allowed.end()) {
    throw Error(key, fmt::format("\"{}\" is not one of: {}", value, fmt::join(allowed, ", ")));
  }
  return value;
}

bool Table::Truth(std::string_view key, bool fallback) const {
  Request(key, {"truth", "", fallback ? "true" : "false"});
  const toml::node* node = Find(node_->table, key);
  if (node == nullptr) return fallback;
  if (!node->is_boolean()) throw Error(key, "must be true or false");
  return node->value<bool>().value();
}

double Table::ReadNumber(std::string_view key, const NumberRule& rule) const {
  const Unit unit = UnitOf(key);
  const toml::node* node = Find(node_->table, key);
  if (node == nullptr) {
    if (!rule.fallback) throw Error(key, "is missing; it must be a number");
    return *rule.fallback;
  }
  if (!node->is_number()) throw Error(key, "must be a number");
  const double value = AsNumber(*node);
  if (!std::isfinite(value)) throw Error(key, "must be a finite number");
  const auto refuse = [&](std::string_view relation, double bound) {
    throw Error(key, fmt::format("is {}, it must be {} {}", WithUnit(value, unit), relation,
                                 WithUnit(bound, unit)));
  };
  if (rule.above && !(value > *rule.above)) refuse("above", *rule.above);
  if (rule.at_least && value < *rule.at_least) refuse("at least", *rule.at_least);
  if (rule.at_most && value > *rule.at_most) refuse("at most", *rule.at_most);
  return value;
}

double Table::Number(std::string_view key, const NumberRule& rule) const {
  Request(key, {"number", std::string(UnitOf(key).name),
                rule.fallback ? fmt::format("{}", *rule.fallback) : ""});
  return ReadNumber(key, rule);
}

double Table::Quantity(std::string_view key, const NumberRule& rule) const {
  return Number(key, rule) * UnitOf(key).si;
}

std::int64_t Table::Integer(std::string_view key, const NumberRule& rule) const {
  const double value = Number(key, rule);
  if (value != std::floor(value) || std::abs(value) > 0x1.0p53) {
    throw Error(key, fmt::format("is {}, it must be a whole number", value));
  }
  return static_cast<std::int64_t>(value);
}

std::vector<double> Table::Quantities(std::string_view key, std::size_t size,
                                      const std::optional<std::vector<double>>& fallback) const {
  const Unit unit = UnitOf(key);
  Request(key, {"numbers", std::string(unit.name),
                fallback ? fmt::format("[{}]", fmt::join(*fallback, ", ")) : ""});
  const std::string wanted =
      size == 0 ? std::string("a list of numbers") : fmt::format("a list of {} numbers", size);
  std::vector<double> values;
  const toml::node* node = Find(node_->table, key);
  if (node == nullptr) {
    if (!fallback) throw Error(key, fmt::format("is missing; it must be {}", wanted));
    values = *fallback;
  } else {
    const toml::array* array = node->as_array();
    if (array == nullptr || (size != 0 && array->size() != size)) {
      throw Error(key, fmt::format("must be {}", wanted));
    }
    for (const toml::node& element : *array) {
      if (!element.is_number() || !std::isfinite(AsNumber(element))) {
        throw Error(key, fmt::format("must be {}", wanted));
      }
      values.push_back(AsNumber(element));
    }
  }
  for (double& value : values) value *= unit.si;
  return values;
}

std::vector<std::string> Table::Texts(
    std::string_view key, std::size_t size,
    const std::optional<std::vector<std::string>>& fallback) const {
  std::vector<std::string> quoted;
  for (const std::string& text : fallback.value_or(std::vector<std::string>{})) {
    quoted.push_back(fmt::format("\"{}\"", text));
  }
  Request(key, {"texts", "", fallback ? fmt::format("[{}]", fmt::join(quoted, ", ")) : ""});
  const std::string wanted =
      size == 0 ? std::string("a list of texts") : fmt::format("a list of {} texts", size);
  const toml::node* node = Find(node_->table, key);
  if (node == nullptr) {
    if (!fallback) throw Error(key, fmt::format("is missing; it must be {}", wanted));
    return *fallback;
  }
  const toml::array* array = node->as_array();
  if (array == nullptr || (size != 0 && array->size() != size)) {
    throw Error(key, fmt::format("must be {}", wanted));
  }
  std::vector<std::string> values;
  for (const toml::node& element : *array) {
    if (!element.is_string()) throw Error(key, fmt::format("must be {}", wanted));
    values.push_back(element.value<std::string>().value());
  }
  return values;
}

Table Table::Child(std::string_view key) const {
  Request(key, {"table", "", "{}"});
  const toml::node* node = Find(node_->table, key);
  if (node != nullptr && !node->is_table()) throw Error(key, "must be a table");
  auto below = std::make_shared<Node>();
  below->table = node == nullptr ? nullptr : node->as_table();
  below->line = node == nullptr ? 0 : node->source().begin.line;
  return Table(state_, std::move(below), Join(path_, key), Join(requested_path_, key),
               std::string(key));
}

std::vector<Table> Table::Children(std::string_view key) const {
  Request(key, {"tables", "", "[]"});
  const toml::node* node = Find(node_->table, key);
  std::vector<Table> children;
  if (node == nullptr) return children;
  const toml::array* array = node->as_array();
  if (array == nullptr) throw Error(key, "must be a list of tables");
  for (std::size_t i = 0; i < array->size(); ++i) {
    const toml::node* element = array->get(i);
    if (!element->is_table()) throw Error(key, "must be a list of tables");
    auto below = std::make_shared<Node>(Node{element->as_table(), element->source().begin.line});
    children.push_back(Table(state_, std::move(below), fmt::format("{}[{}]", Join(path_, key), i),
                             Join(requested_path_, key) + "[]", std::string(key)));
  }
  return children;
}

std::vector<Table> Table::Named() const {
  std::vector<Table> named;
  if (node_->table == nullptr) return named;
  const auto& requested_here = state_->known[path_];
  for (const auto& [key, node] : *node_->table) {
    if (!node.is_table() || requested_here.contains(key.str())) continue;
    state_->named[path_].emplace(key.str());
    auto below = std::make_shared<Node>(Node{node.as_table(), node.source().begin.line});
    named.push_back(Table(state_, std::move(below), Join(path_, key.str()),
                          Join(requested_path_, "[]"), std::string(key.str())));
  }
  std::ranges::stable_sort(named, {}, [](const Table& table) { return table.node_->line; });
  return named;
}

void Table::RefuseUnknown() const {
  if (node_->table == nullptr) return;
  const auto& known = state_->known[path_];
  const auto& named = state_->named[path_];
  for (const auto& [key, node] : *node_->table) {
    if (known.contains(key.str()) || named.contains(key.str())) continue;
    const std::string nearest =
        NearestWord(key.str(), std::vector<std::string>(known.begin(), known.end()));
    throw Error(key.str(), nearest.empty()
                               ? std::string("is not a known key")
                               : fmt::format("is not a known key; did you mean \"{}\"?", nearest));
  }
}

}  // namespace abbe::settings
