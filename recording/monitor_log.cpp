#include "recording/monitor_log.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include "recording/line_reader.h"
#include "settings/toml_text.h"

namespace abbe::recording {
namespace {

using Nanoseconds = std::int64_t;
constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr double kNanosecond = 1e-9;

template <typename T>
std::optional<T> Parse(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string_view NextWord(std::string_view& line) {
  const auto first = line.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  line.remove_prefix(first);
  const std::string_view word = line.substr(0, line.find_first_of(" \t"));
  line.remove_prefix(word.size());
  return word;
}

// Whether `text` matches `form`, in which 0 is any digit.
bool Matches(std::string_view text, std::string_view form) {
  return std::equal(text.begin(), text.end(), form.begin(), form.end(),
                    [](char is, char as) { return as == '0' ? is >= '0' && is <= '9' : is == as; });
}

// The time since 1970, on the same clock, of "2023-02-08" and "14:21:15.970781".
std::optional<Nanoseconds> InstantOf(std::string_view date, std::string_view time) {
  constexpr int kFirstYear = 1970, kLastYear = 2200;  // the range of nanoseconds in 64 bits
  constexpr std::string_view kSeconds = "00:00:00";
  const std::string_view decimals = time.substr(std::min(time.size(), kSeconds.size()));
  if (!Matches(date, "0000-00-00") || !Matches(time.substr(0, kSeconds.size()), kSeconds) ||
      (!decimals.empty() &&
       (decimals[0] != '.' || decimals.size() == 1 ||
        decimals.find_first_not_of("0123456789", 1) != std::string_view::npos))) {
    return std::nullopt;
  }
  const auto year = Parse<int>(date.substr(0, 4));
  const auto month = Parse<unsigned>(date.substr(5, 2)), day = Parse<unsigned>(date.substr(8, 2));
  const auto hour = Parse<int>(time.substr(0, 2)), minute = Parse<int>(time.substr(3, 2));
  const auto second = Parse<double>(time.substr(6));
  if (!year || !month || !day || !hour || !minute || !second) return std::nullopt;
  if (*year < kFirstYear || *year > kLastYear) return std::nullopt;
  if (*hour > 23 || *minute > 59 || !(*second < 60.0)) return std::nullopt;
  using namespace std::chrono;
  const year_month_day calendar_day{std::chrono::year(*year), std::chrono::month(*month),
                                    std::chrono::day(*day)};
  if (!calendar_day.ok()) return std::nullopt;
  const auto midnight = duration_cast<nanoseconds>(sys_days(calendar_day).time_since_epoch());
  return (midnight + hours(*hour) + minutes(*minute)).count() + std::llround(*second / kNanosecond);
}

struct Line {
  std::string_view channel, date, time, value;
  std::optional<Nanoseconds> instant;
};

Line LineOf(std::string_view text) {
  Line line;
  line.channel = NextWord(text);
  line.date = NextWord(text);
  line.time = NextWord(text);
  line.value = NextWord(text);
  line.instant = InstantOf(line.date, line.time);
  return line;
}

class LogReader {
 public:
  LogReader(const std::filesystem::path& path, const std::vector<MonitoredColumn>& columns,
            const std::vector<double>& sensor_degrees)
      : path_(path.string()),
        columns_(columns),
        kind_(sensor_degrees.empty() ? std::string("kind = \"dwell\"\n")
                                     : fmt::format("kind = \"shaft\"\nsensor_deg = [{}]\n",
                                                   fmt::join(sensor_degrees, ", "))),
        spoke_(columns.size(), false) {
    if (columns.empty()) {
      throw InputError(
          fmt::format("{}: the log of a monitor has no quantities and units; name the channels as "
                      "columns with their units, for example shaft_deg=CHANNEL",
                      path_));
    }
  }

  Recording Read() {
    LineReader lines(path_);
    while (const auto text = lines.Next()) Take(*text, lines.number());
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (spoke_[i]) continue;
      throw InputError(fmt::format("{}: channel \"{}\" has no value; the log has {}", path_,
                                   columns_[i].channel, fmt::join(channels_, ", ")));
    }
    return Rows();
  }

 private:
  void Take(std::string_view text, std::size_t number) {
    const Line line = LineOf(text);
    if (line.channel.empty()) return;
    if (!channels_.contains(line.channel)) channels_.emplace(line.channel);
    if (line.date == "***") return;
    if (!line.instant) {
      throw InputError(fmt::format(
          "{}:{}: no date and time after \"{}\"; a line of a monitor is channel, date, time, value",
          path_, number, line.channel));
    }
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      if (columns_[i].channel != line.channel) continue;
      const auto value = Parse<double>(line.value);
      if (!value || !std::isfinite(*value)) {
        throw InputError(fmt::format("{}:{}: \"{}\" of {} is not a number; leave the channel out",
                                     path_, number, line.value, line.channel));
      }
      if (instants_.empty() || *line.instant < instants_.begin()->first) {
        started_ = fmt::format("{}T{}", line.date, line.time);
      }
      auto& row = instants_[*line.instant];
      row.resize(columns_.size(), kNotANumber);
      row[i] = *value;
      spoke_[i] = true;
    }
  }

  Recording Rows() const {
    Recording recording;
    recording.name = path_;
    recording.header =
        fmt::format("{}started = {}\nimported_from = {}\n[sources]\n", kind_, started_,
                    settings::Quoted(std::filesystem::path(path_).filename().string()));
    recording.columns.push_back({"time_s", {}});
    for (const MonitoredColumn& column : columns_) {
      recording.header +=
          fmt::format("{} = {}\n", settings::Key(column.name), settings::Quoted(column.channel));
      recording.columns.push_back({column.name, {}});
    }
    for (const auto& [instant, row] : instants_) {
      const double since = instant - instants_.begin()->first;
      recording.columns[0].values.push_back(since * kNanosecond);
      for (std::size_t i = 0; i < row.size(); ++i) {
        recording.columns[i + 1].values.push_back(row[i]);
      }
    }
    return recording;
  }

  std::string path_;
  const std::vector<MonitoredColumn>& columns_;
  const std::string kind_;  // lines of the header
  std::vector<bool> spoke_;
  std::set<std::string, std::less<>> channels_;
  std::map<Nanoseconds, std::vector<double>> instants_;
  std::string started_;
};

}  // namespace

bool IsMonitorLog(const std::filesystem::path& path) {
  LineReader lines(path);
  const auto first = lines.Next();
  return first && LineOf(*first).instant.has_value();
}

Recording ReadMonitorLog(const std::filesystem::path& path,
                         const std::vector<MonitoredColumn>& columns,
                         const std::vector<double>& sensor_degrees) {
  return LogReader(path, columns, sensor_degrees).Read();
}

}  // namespace abbe::recording
