// The table [certificate]: what it must have, and what is said where it has not.
#include "certificate/administration.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>

#include "map/map_cases.h"

namespace abbe::certificate {
namespace administration_test {

constexpr const char* kText = R"([certificate]
number = "2026-017"
performed = ["2026-11-20", "2026-11-21"]
location = "laboratory"
[certificate.laboratory]
name = "Lab"
city = "Bern"
country = "CH"
[certificate.customer]
name = "Customer"
city = "Leeds"
country = "GB"
[[certificate.person]]
name = "A. Metrologist"
[certificate.item]
name = "mill"
manufacturer = "Maker"
serial = "4711"
)";

Administration Read(const std::string& text) {
  const auto document = settings::Document::Parse(text, "mill.toml");
  const Administration read = ReadAdministration(document.Root());
  document.Root().RefuseUnknown();
  return read;
}

std::string With(std::string text, const std::string& line, const std::string& other) {
  const auto at = text.find(line);
  EXPECT_NE(at, std::string::npos) << line;
  return text.replace(at, line.size(), other);
}

TEST(Administration, NamesEveryKeyThatIsMissing) {
  EXPECT_EQ(Read(kText).decision_rule, "ISO 14253-1");
  constexpr std::array<std::pair<const char*, const char*>, 13> kLines{
      {{"number = \"2026-017\"\n", "certificate.number"},
       {"performed = [\"2026-11-20\", \"2026-11-21\"]\n", "certificate.performed"},
       {"location = \"laboratory\"\n", "certificate.location"},
       {"name = \"Lab\"\n", "certificate.laboratory.name"},
       {"city = \"Bern\"\n", "certificate.laboratory.city"},
       {"country = \"CH\"\n", "certificate.laboratory.country"},
       {"name = \"Customer\"\n", "certificate.customer.name"},
       {"city = \"Leeds\"\n", "certificate.customer.city"},
       {"country = \"GB\"\n", "certificate.customer.country"},
       {"[[certificate.person]]\nname = \"A. Metrologist\"\n", "certificate.person"},
       {"name = \"mill\"\n", "certificate.item.name"},
       {"manufacturer = \"Maker\"\n", "certificate.item.manufacturer"},
       {"serial = \"4711\"\n", "certificate.item.serial"}}};
  for (const auto& [line, key] : kLines) {
    const std::string message =
        map::MessageOf<InputError>([&, line = line] { Read(With(kText, line, "")); });
    map::ExpectHas(message, "mill.toml");
    map::ExpectHas(message, std::string(key) + ": ");
  }
  map::ExpectHas(map::MessageOf<InputError>([] { Read("name = \"mill\"\n"); }), "[certificate]");
}

TEST(Administration, RefusesValuesThatNoCertificateCanHold) {
  constexpr std::array<std::array<const char*, 3>, 9> kCases{
      {{"2026-11-21", "2026-11-31", "is no date"},
       {"\"2026-11-20\"", "\"2026-11-22\"", "ends before it begins"},
       {"number =", "issued = \"2026-11-20\"\nnumber =",
        "before the calibration ended on 2026-11-21"},
       {"\"CH\"", "\"Switzerland\"", "two capital letters"},
       {"\"4711\"", "\"\"", "is empty"},
       {"\"4711\"", "\" 4711\"", "blank"},
       {"\"4711\"", "\"47\\n11\"", "line break"},
       {"serial = \"4711\"", "serial = \"4711\"\nowner = \"x\"", "owner"},
       {"serial = \"4711\"\n",
        "serial = \"4711\"\n[[certificate.instrument]]\nname = \"a\"\nserial = "
        "\"1\"\ncertificate = \"2\"\n",
        "certificate_by"}}};
  for (const auto& [from, to, saying] : kCases) {
    map::ExpectHas(
        map::MessageOf<InputError>([&, from = from, to = to] { Read(With(kText, from, to)); }),
        saying);
  }
}

}  // namespace administration_test
}  // namespace abbe::certificate
