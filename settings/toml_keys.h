// The keys of a TOML text, read and changed one by one: everything else stays as a person wrote it,
// comments too.
//
//   const TomlKeys mill(text, "mill.toml");
//   mill.Value("sweep.X.last_mm");                              // 60.0
//   const TomlKeys longer = mill.With("sweep.X.last_mm", 80.0);
//   longer.text();
//
// A key is named as in messages: "head.arm_mm", "linkage.joint[2].d_mm"; elements of lists of tables
// count from 0. A key that is not there is added below the header of its table, a table at the end.
// Units: as written. Shapes: a value is true or false, a number, a text or a list of one of the last
// two.
// Failure: InputError with the name of the text for one that is no TOML, a key that is a table or
// stands in one that has no header of its own, a value that TOML does not have.
// Source: TOML 1.0. Validity: what is read again differs from what was there by that key alone, or it
// is refused.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace abbe::settings {

using TomlValue = std::variant<bool, std::int64_t, double, std::string, std::vector<double>,
                               std::vector<std::string>>;

class TomlKeys {
 public:
  // `name` stands for the text in messages.
  TomlKeys(std::string text, std::string name);

  const std::string& text() const { return text_; }
  const std::string& name() const { return name_; }
  // All that have a value, by table and in the order of the alphabet.
  std::vector<std::string> Names() const;
  // InputError where it is absent or no value of the type above.
  TomlValue Value(std::string_view key) const;
  // Another text.
  TomlKeys With(std::string_view key, const TomlValue& value) const;

 private:
  std::string text_, name_;
};

}  // namespace abbe::settings
