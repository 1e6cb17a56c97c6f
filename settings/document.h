// Strict reading of TOML: every key is asked for by name, converted to SI by the unit in its name,
// and checked; a key that nobody asked for is an error that names the nearest known key and the
// line.
//
//   const auto document = settings::Document::Read("machine.toml");
//   const settings::Table head = document.Root().Child("head");
//   const double arm = head.Quantity("arm_mm", {.fallback = 10.0, .above = 0.0});  // -> metres
//   head.RefuseUnknown();
//
// All errors are InputError and begin with "file:line: table.key: ".
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "failure/failure.h"

namespace abbe::settings {

// What a number may be, in the unit of the key. Without a fallback the key is required.
struct NumberRule {
  std::optional<double> fallback{};
  std::optional<double> above{};     // value > above
  std::optional<double> at_least{};  // value >= at_least
  std::optional<double> at_most{};   // value <= at_most
};

// One key that a reader asked for, for the documentation and its test.
struct AskedKey {
  std::string type;      // "number", "text", "truth", "numbers", "texts", "table", "tables"
  std::string unit;      // as in Unit::name
  std::string fallback;  // as written in a file; empty when the key is required
};

class Table;

class Document {
 public:
  // Throws InputError when the file cannot be read or is not TOML.
  static Document Read(const std::filesystem::path& path);
  // `name` stands for the file in messages.
  static Document Parse(std::string_view text, std::string name);

  Table Root() const;

  const std::string& name() const;
  // Everything that was asked for so far, by dotted path; elements of arrays of tables and of
  // named collections read "[]".
  const std::map<std::string, AskedKey>& asked() const;

 private:
  friend class Table;
  struct State;
  explicit Document(std::shared_ptr<State> state);
  std::shared_ptr<State> state_;
};

// A table of a document. Cheap to copy; keeps its document alive.
class Table {
 public:
  bool Has(std::string_view key) const;

  std::string Text(std::string_view key) const;
  std::string Text(std::string_view key, std::string_view fallback) const;
  // One of `allowed`; the first is the fallback when `required` is false.
  std::string Choice(std::string_view key, const std::vector<std::string>& allowed,
                     bool required = false) const;
  bool Truth(std::string_view key, bool fallback) const;

  // A number as written.
  double Number(std::string_view key, const NumberRule& rule = {}) const;
  // A number in SI, converted by the unit in the key's name; the rule is in the unit of the key.
  double Quantity(std::string_view key, const NumberRule& rule = {}) const;
  std::int64_t Integer(std::string_view key, const NumberRule& rule = {}) const;

  // Lists; `size` 0 accepts any length. Without a fallback the key is required. Quantities are SI,
  // their fallback is in the unit of the key.
  std::vector<double> Quantities(std::string_view key, std::size_t size,
                                 const std::optional<std::vector<double>>& fallback = {}) const;
  std::vector<std::string> Texts(
      std::string_view key, std::size_t size,
      const std::optional<std::vector<std::string>>& fallback = {}) const;

  // A table below this one; an absent table reads as an empty one, so that its keys take their
  // fallbacks or say that they are missing.
  Table Child(std::string_view key) const;
  // An array of tables; empty when absent.
  std::vector<Table> Children(std::string_view key) const;
  // Every table below this one that has a name of the user's choice, e.g. the devices, in the order
  // of the file. Keys that were asked for by name before are not among them.
  std::vector<Table> Named() const;

  // Throws when this table (not the tables below it) holds a key that was not asked for.
  void RefuseUnknown() const;

  // The last part of the path: the name of a Named() table.
  const std::string& key() const { return key_; }
  // "file:line: path.key: message", to be thrown by a reader that finds a bad value. An empty `key`
  // means the table itself.
  InputError Error(std::string_view key, std::string_view message) const;

 private:
  friend class Document;
  struct Node;  // hides the TOML library
  Table(std::shared_ptr<Document::State> state, std::shared_ptr<const Node> node, std::string path,
        std::string asked_path, std::string key);
  void Ask(std::string_view key, const AskedKey& asked) const;
  double ReadNumber(std::string_view key, const NumberRule& rule) const;

  std::shared_ptr<Document::State> state_;
  std::shared_ptr<const Node> node_;
  std::string path_;        // "devices.head"
  std::string asked_path_;  // "devices.[]"
  std::string key_;
};

}  // namespace abbe::settings
