// docs/machine-file.md against the readers: every key that a reader asks for stands in the page
// with its unit and its default. Names of the user's choice stand there as AXIS, P and NAME.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

#include "../folders.h"
#include "apps/machine_file.h"

namespace abbe::apps {
namespace machine_file_page_test {

std::string GeneralName(const std::string& path) {
  std::string name = std::regex_replace(path, std::regex("\\b(axis|sweep)\\.[XYZ]\\b"), "$1.AXIS");
  name = std::regex_replace(name, std::regex("axis_[XYZ]"), "axis_AXIS");
  name = std::regex_replace(name, std::regex("probe_[a-e]\\."), "probe_P.");
  name = std::regex_replace(name, std::regex("(devices|screw)\\.\\[\\]"), "$1.NAME");
  // Limits: every figure of every object.
  name = std::regex_replace(name, std::regex("^limits\\.\\[\\]\\.u95_urad$"),
                            "limits.OBJECT.QUANTITY_u95_urad");
  name = std::regex_replace(name, std::regex("^limits\\.\\[\\]\\.(?!urad$)\\w+?((_u95)?_[a-z]+)$"),
                            "limits.OBJECT.QUANTITY$1");
  name = std::regex_replace(name, std::regex("^limits\\.\\[\\]\\."), "limits.OBJECT.");
  name = std::regex_replace(name, std::regex("^limits\\.(?!OBJECT)\\w+?((_u95)?_[a-z]+)$"),
                            "limits.QUANTITY$1");
  name = std::regex_replace(name, std::regex("^drift\\.temperature\\.\\[\\]"),
                            "drift.temperature.NAME");
  return std::regex_replace(name, std::regex("\\.\\[\\]"), "");
}

struct Row {
  std::string unit, fallback;
};

// The rows "| `key` | unit | default | meaning |" of the page.
std::map<std::string, Row> RowsOfPage() {
  std::ifstream page(SourceFolder() / "docs/machine-file.md");
  EXPECT_TRUE(page) << "docs/machine-file.md cannot be read";
  std::map<std::string, Row> rows;
  const std::regex row(R"(\| `([^`]+)` \| ([^|]*?) *\| ([^|]*?) *\| [^|]+\|)");
  for (std::string line; std::getline(page, line);) {
    std::smatch match;
    if (std::regex_match(line, match, row)) rows[match[1]] = {match[2], match[3]};
  }
  return rows;
}

// The demonstration machine with the keys that a file may do without.
constexpr char kMore[] = R"(
[limits]
EYX = { straightness_um = 3 }
EAX = { range_urad = 30 }
C0Y = { urad = 30 }
[certificate]
number = "1"
performed = ["2026-11-21", "2026-11-22"]
location = "other"
laboratory = { name = "a", city = "b", country = "DE" }
customer = { name = "a", city = "b", country = "DE" }
item = { name = "a", manufacturer = "b", serial = "c" }
person = [{ name = "a" }]
instrument = [{ name = "a", serial = "b" }]
condition = [{ name = "a", text = "b" }]
[drift.temperature.table]
scale_ppm = 12
[devices.more]
transport = "modbus-rtu"
serial = { device = "/dev/ttyUSB0" }
[[devices.more.block]]
address = 0
count = 4
channel = [
  { name = "temp_more_c", at = 0, type = "int16", minimum = -10, maximum = 50, status = { at = 3 } },
  { name = "temp_other_c", at = 1, type = "int16", status = { address = 2 } },
]
[devices.encoder]
transport = "canopen"
interface = "can0"
node = [{ id = 1, name = "pivot_9_rad", counts_per_turn = 4096, serial = 7 }]
)";

std::string Demo() {
  std::ifstream demo(DemoMillFile());
  std::string text{std::istreambuf_iterator<char>(demo), {}};
  const std::string probe = "[head.probe_a]\n";
  text.insert(text.find(probe) + probe.size(), "zero_gap_um = 100.0\n");
  return text + kMore;
}

// The demonstration machine with the linkage in another of its forms.
std::string DemoWithForm(const std::string& form, const std::string& links) {
  const std::string demo = Demo();
  const std::string text =
      std::regex_replace(demo, std::regex("form = \"pivots\"\nlink_1_mm.*\nlink_2_mm.*\nelbow.*\n"),
                         fmt::format("form = \"{}\"\n{}\n", form, links));
  EXPECT_NE(text, demo) << "machines/demo_mill.toml has no linkage of form \"pivots\"";
  return text;
}

void AddKeysOf(const std::string& text, std::map<std::string, settings::RequestedKey>& keys) {
  const auto path =
      std::filesystem::temp_directory_path() / fmt::format("abbe_machine_file_{}.toml", ::getpid());
  std::ofstream(path) << text;
  const MachineFile file = ReadMachineFile(path);
  std::filesystem::remove(path);
  for (const auto& [name, key] : file.document.requested()) keys.emplace(name, key);
}

std::map<std::string, settings::RequestedKey> KeysOfAllReaders() {
  std::map<std::string, settings::RequestedKey> keys;
  AddKeysOf(Demo(), keys);
  AddKeysOf(DemoWithForm("segments", "segment = [{ length_mm = 9, encoder = \"theta\" }]"), keys);
  AddKeysOf(DemoWithForm("denavit-hartenberg",
                         "joint = [{ a_mm = 9 }]\n"
                         "mass = [{ after_pivot = 1, kg = 9, point_mm = [9, 0, 0] }]"),
            keys);
  AddKeysOf(DemoWithForm("axes",
                         "ball_mm = [9, 0, 0]\n"
                         "axis = [{ point_mm = [0, 0, 0], direction = [0, 0, 1] }]"),
            keys);
  return keys;
}

TEST(MachineFilePage, HasEveryKeyWithUnitAndDefault) {
  const auto rows = RowsOfPage();
  std::set<std::string> asked;
  for (const auto& [path, key] : KeysOfAllReaders()) {
    if (key.type == "table" || key.type == "tables") continue;
    const std::string name = GeneralName(path);
    asked.insert(name);
    const auto row = rows.find(name);
    if (row == rows.end()) {
      ADD_FAILURE() << fmt::format("the page lacks: | `{}` | {} | {} | ... |", name, key.unit,
                                   key.fallback.empty() ? "required" : key.fallback);
      continue;
    }
    EXPECT_EQ(row->second.unit, key.unit) << name;
    EXPECT_NE(row->second.fallback.find(key.fallback), std::string::npos)
        << name << ": the default is " << key.fallback << ", the page says "
        << row->second.fallback;
    // A key that must be there unless another or nothing takes its place has no default either.
    const bool none = row->second.fallback == "none" || name == "head.probe_P.zero_gap_um";
    EXPECT_EQ(key.fallback.empty(), none || row->second.fallback == "required") << name;
  }
  for (const auto& [name, row] : rows) EXPECT_TRUE(asked.contains(name)) << name << " is no key";
}

}  // namespace machine_file_page_test
}  // namespace abbe::apps
