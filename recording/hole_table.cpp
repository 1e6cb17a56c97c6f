#include "recording/hole_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "recording/line_reader.h"
#include "settings/toml_text.h"

namespace abbe::recording {
namespace {

constexpr std::array<std::string_view, 4> kNames{"Meas X", "Meas Y", "Nom X", "Nom Y"};

bool IsBlank(char c) { return c == ' ' || c == '\t'; }

// The words of a line, separated by at least `blanks` blanks or a tab.
std::vector<std::string_view> Words(std::string_view line, std::size_t blanks) {
  std::vector<std::string_view> words;
  std::size_t at = 0;
  while (true) {
    while (at < line.size() && IsBlank(line[at])) ++at;
    if (at == line.size()) return words;
    std::size_t end = at;
    for (std::size_t gap = at; gap < line.size(); ++gap) {
      if (!IsBlank(line[gap])) {
        end = gap + 1;
      } else if (line[gap] == '\t' || gap + 1 - end >= blanks) {
        break;
      }
    }
    words.push_back(line.substr(at, end - at));
    at = end;
  }
}

// The columns of the four names; for a missing one the number of columns.
std::array<std::size_t, 4> PlacesOf(const std::vector<std::string_view>& names) {
  std::array<std::size_t, 4> places{};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    places[i] = std::find(names.begin(), names.end(), kNames[i]) - names.begin();
  }
  return places;
}

double Number(std::string_view word, const std::string& place) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error == std::errc{} && end == word.data() + word.size() && std::isfinite(value)) {
    return value;
  }
  throw InputError(
      fmt::format("{}: \"{}\" is not a number; correct it or remove the row", place, word));
}

}  // namespace

Recording ReadHoleTable(const std::filesystem::path& path, double u_probing_um) {
  Recording recording;
  recording.name = path.string();
  recording.header = fmt::format("kind = \"plate\"\nimported_from = {}\n",
                                 settings::Quoted(path.filename().string()));
  if (u_probing_um > 0.0) recording.header += fmt::format("u_probing_um = {}\n", u_probing_um);
  for (const char* name : {"x_mm", "y_mm", "z_mm", "setup", "hole", "plate_x_mm", "plate_y_mm"}) {
    recording.columns.push_back({name, {}});
  }
  LineReader lines(path);
  std::size_t width = 0;  // 0: before the line of names
  std::array<std::size_t, 4> places{};
  while (const auto line = lines.Next()) {
    if (width == 0) {
      const auto names = Words(*line, 2);
      places = PlacesOf(names);
      if (*std::max_element(places.begin(), places.end()) < names.size()) width = names.size();
      continue;
    }
    const auto words = Words(*line, 1);
    if (words.empty()) continue;
    const std::string place = fmt::format("{}:{}", path.string(), lines.number());
    if (words.size() != width) {
      throw InputError(
          fmt::format("{}: has {} numbers for {} names; complete the row "
                      "or remove it",
                      place, words.size(), width));
    }
    std::array<double, 4> values{};
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = Number(words[places[i]], place);
    const double hole = recording.rows() + 1;
    const std::array<double, 7> row{values[0], values[1], 0.0, 1.0, hole, values[2], values[3]};
    for (std::size_t i = 0; i < row.size(); ++i) recording.columns[i].values.push_back(row[i]);
  }
  if (recording.rows() > 0) return recording;
  throw InputError(
      fmt::format("{}: {}; a table of holes has a line of names with {}, and a row for "
                  "each hole",
                  path.string(), width == 0 ? "has no line of such names" : "has no rows",
                  fmt::join(kNames, ", ")));
}

}  // namespace abbe::recording
