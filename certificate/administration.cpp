#include "certificate/administration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <utility>

namespace abbe::certificate {
namespace {

using settings::Table;

// What XML and the types of DCC take: no control characters, no blanks at the ends.
std::string Checked(const Table& table, const char* key, std::string text) {
  const auto is_control = [](unsigned char each) { return each < 0x20 || each == 0x7f; };
  if (std::any_of(text.begin(), text.end(), is_control)) {
    throw table.Error(key, "has a control character or a line break; write it in one line");
  }
  if (!text.empty() && (text.front() == ' ' || text.back() == ' ')) {
    throw table.Error(key, "begins or ends with a blank; take it out");
  }
  return text;
}

std::string Required(const Table& table, const char* key) {
  std::string text = Checked(table, key, table.Text(key));
  if (text.empty()) throw table.Error(key, "is empty; a certificate needs it");
  return text;
}

std::string Optional(const Table& table, const char* key) {
  return Checked(table, key, table.Text(key, ""));
}

bool IsDate(const std::string& text) {
  constexpr std::string_view kForm = "0000-00-00";
  if (text.size() != kForm.size()) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool fits = kForm[i] == '-' ? text[i] == '-' : text[i] >= '0' && text[i] <= '9';
    if (!fits) return false;
  }
  const std::chrono::year_month_day date{std::chrono::year(std::stoi(text.substr(0, 4))),
                                         std::chrono::month(std::stoi(text.substr(5, 2))),
                                         std::chrono::day(std::stoi(text.substr(8, 2)))};
  return date.ok();
}

std::string Date(const Table& table, const char* key, const std::string& text) {
  if (text.empty() || IsDate(text)) return text;
  throw table.Error(key, fmt::format("\"{}\" is no date; write it as \"2026-11-21\"", text));
}

std::string Country(const Table& table) {
  std::string text = Required(table, "country");
  const auto is_capital = [](char each) { return each >= 'A' && each <= 'Z'; };
  if (text.size() == 2 && std::all_of(text.begin(), text.end(), is_capital)) return text;
  throw table.Error("country", "must be two capital letters of ISO 3166-1, such as \"DE\"");
}

Organization ReadOrganization(const Table& table) {
  Organization read;
  read.name = Required(table, "name");
  read.street = Optional(table, "street");
  read.post_code = Optional(table, "post_code");
  read.city = Required(table, "city");
  read.country = Country(table);
  read.email = Optional(table, "email");
  read.phone = Optional(table, "phone");
  table.RefuseUnknown();
  return read;
}

Organization ReadLaboratory(const Table& table) {
  std::string code = Optional(table, "code");
  Organization read = ReadOrganization(table);
  read.code = std::move(code);
  return read;
}

Person ReadPerson(const Table& table) {
  Person person{Required(table, "name"), Optional(table, "role"), table.Truth("signs", false)};
  table.RefuseUnknown();
  return person;
}

Item ReadItem(const Table& table) {
  Item item{Required(table, "name"), Required(table, "manufacturer"), Optional(table, "model"),
            Required(table, "serial")};
  table.RefuseUnknown();
  return item;
}

Instrument ReadInstrument(const Table& table) {
  Instrument read;
  read.name = Required(table, "name");
  read.manufacturer = Optional(table, "manufacturer");
  read.model = Optional(table, "model");
  read.serial = Required(table, "serial");
  read.certificate = Optional(table, "certificate");
  read.certificate_by = Optional(table, "certificate_by");
  read.certificate_sha256 = Optional(table, "certificate_sha256");
  const std::string& hash = read.certificate_sha256;
  const auto is_digit = [](unsigned char each) { return std::isxdigit(each) != 0; };
  if (!hash.empty() && (hash.size() != 64 || !std::all_of(hash.begin(), hash.end(), is_digit))) {
    throw table.Error("certificate_sha256", "must be 64 hexadecimal digits, as sha256sum prints");
  }
  if (read.certificate.empty() != read.certificate_by.empty()) {
    throw table.Error(read.certificate.empty() ? "certificate" : "certificate_by",
                      "is missing; a certificate has a number and a laboratory that issued it");
  }
  if (read.certificate.empty() && !hash.empty()) {
    throw table.Error("certificate", "is missing; the hash is that of a certificate");
  }
  table.RefuseUnknown();
  return read;
}

Condition ReadCondition(const Table& table) {
  Condition condition{Required(table, "name"), Required(table, "text")};
  table.RefuseUnknown();
  return condition;
}

}  // namespace

Administration ReadAdministration(const Table& root) {
  if (!root.Has("certificate")) {
    throw root.Error("certificate",
                     "is missing; write a table [certificate] (docs/certificate.md has one to "
                     "copy)");
  }
  const Table table = root.Child("certificate");
  Administration read;
  read.number = Required(table, "number");
  const auto performed = table.Texts("performed", 2);
  for (const std::string& date : performed) {
    if (date.empty()) throw table.Error("performed", "has an empty date");
  }
  read.begin = Date(table, "performed", performed[0]);
  read.end = Date(table, "performed", performed[1]);
  if (read.end < read.begin) throw table.Error("performed", "ends before it begins");
  read.received = Date(table, "received", Optional(table, "received"));
  read.issued = Date(table, "issued", Optional(table, "issued"));
  if (!read.issued.empty() && read.issued < read.end) {
    throw table.Error("issued", fmt::format("is {}, before the calibration ended on {}; correct "
                                            "issued or performed",
                                            read.issued, read.end));
  }
  read.location = table.Choice(
      "location", {"laboratory", "customer", "laboratoryBranch", "customerBranch", "other"}, true);
  read.decision_rule = table.Choice("decision_rule", {kIso14253, "none"});
  read.laboratory = ReadLaboratory(table.Child("laboratory"));
  read.customer = ReadOrganization(table.Child("customer"));
  for (const Table& each : table.Children("person")) read.people.push_back(ReadPerson(each));
  if (read.people.empty()) {
    throw table.Error("person", "is missing; write [[certificate.person]] with name and role");
  }
  read.item = ReadItem(table.Child("item"));
  for (const Table& each : table.Children("instrument")) {
    read.instruments.push_back(ReadInstrument(each));
  }
  for (const Table& each : table.Children("condition")) {
    read.conditions.push_back(ReadCondition(each));
  }
  table.RefuseUnknown();
  return read;
}

}  // namespace abbe::certificate
