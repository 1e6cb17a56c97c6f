// What a certificate says beside the results: the laboratory, the customer, the item, the people,
// the instruments and the conditions, from the table [certificate] of a TOML file.
//
//   const auto document = settings::Document::Read("mill.toml");
//   const Administration data = ReadAdministration(document.Root());
//   fmt::print("{} for {}\n", data.number, data.customer.name);
//
// Dates: "2026-11-21". Failure: InputError with file, line and key for what is missing, empty or of
// another form. Source: the mandatory elements of DCC 3.2.0 (PTB). Validity: one item.
#pragma once

#include <string>
#include <vector>

#include "settings/document.h"

namespace abbe::certificate {

struct Organization {
  std::string name, code, street, post_code, city, country, email, phone;
  bool operator==(const Organization&) const = default;
};

struct Person {
  std::string name, role;
  bool signs = false;  // signs the certificate
  bool operator==(const Person&) const = default;
};

struct Item {
  std::string name, manufacturer, model, serial;
  bool operator==(const Item&) const = default;
};

// An instrument with the certificate of its own calibration, if it has one.
struct Instrument {
  std::string name, manufacturer, model, serial;
  std::string certificate, certificate_by, certificate_sha256;
  bool operator==(const Instrument&) const = default;
};

struct Condition {
  std::string name, text;
  bool operator==(const Condition&) const = default;
};

struct Administration {
  std::string number, begin, end, received, issued;
  std::string location;       // of the calibration: "laboratory", "customer", ...
  std::string decision_rule;  // "ISO 14253-1" or "none"
  Organization laboratory, customer;
  std::vector<Person> people;
  Item item;
  std::vector<Instrument> instruments;
  std::vector<Condition> conditions;
  bool operator==(const Administration&) const = default;
};

inline constexpr const char* kIso14253 = "ISO 14253-1";

// InputError, with the place to look at, when the file has no table [certificate].
Administration ReadAdministration(const settings::Table& root);

}  // namespace abbe::certificate
