#include "diagnosis/data_integrity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include "recording/good_rows.h"

namespace abbe::diagnosis {
namespace {

using Values = std::vector<double>;

constexpr double kStays = 5e-3;   // mm: nearer rows are of one stay
constexpr double kPause = 0.5;    // s: rows farther apart are no neighbours
constexpr std::size_t kStay = 5;  // rows that have a median worth the name
constexpr double kFlag = 4.0;     // device error

struct Channel {
  std::string object;
  Values values;
};

// What the rows that count have in common, and the channels of the instrument.
struct Table {
  std::vector<std::size_t> rows;
  Values time;
  std::vector<Values> axes;                 // mm
  std::vector<std::size_t> stay_end, stay;  // of each row: the row after its stay, rows in it
  std::vector<Channel> channels;
};

double MedianOf(Values values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Values At(const recording::Recording& recording, const std::string& column,
          const std::vector<std::size_t>& rows) {
  const auto all = recording.Find(column);
  Values values;
  if (all) {
    for (const std::size_t row : rows) values.push_back((*all)[row]);
  }
  return values;
}

Table TableOf(const recording::Recording& recording) {
  Table table;
  table.rows = recording::GoodRows(recording);
  table.time = At(recording, "time_s", table.rows);
  for (const char* name : {"x_mm", "y_mm", "z_mm"}) {
    if (recording.Find(name)) table.axes.push_back(At(recording, name, table.rows));
  }
  table.stay_end.resize(table.rows.size());
  table.stay.resize(table.rows.size());
  for (std::size_t first = 0; first < table.rows.size();) {
    std::size_t last = first + 1;
    const auto together = [&](const Values& axis) {
      return std::abs(axis[last] - axis[first]) < kStays;
    };
    while (last < table.rows.size() && table.time[last] - table.time[last - 1] < kPause &&
           std::all_of(table.axes.begin(), table.axes.end(), together)) {
      ++last;
    }
    std::fill(table.stay_end.begin() + static_cast<std::ptrdiff_t>(first),
              table.stay_end.begin() + static_cast<std::ptrdiff_t>(last), last);
    std::fill(table.stay.begin() + static_cast<std::ptrdiff_t>(first),
              table.stay.begin() + static_cast<std::ptrdiff_t>(last), last - first);
    first = last;
  }
  for (const auto& column : recording.columns) {
    const std::size_t unit = column.name.rfind('_');
    if (!column.name.starts_with("probe_") && !column.name.starts_with("pivot_")) continue;
    table.channels.push_back({column.name.substr(0, unit), At(recording, column.name, table.rows)});
  }
  return table;
}

// First row of the five, with this one, that belong to the same motion and lie around it as evenly
// as can be; none: the number of rows.
std::size_t FiveAround(const Table& table, std::size_t row) {
  const auto one_motion = [&](std::size_t first) {
    if (first + 5 > table.time.size()) return false;
    for (std::size_t i = first; i < first + 5; ++i) {
      if (table.stay[i] >= kStay) return false;
      if (i > first && table.time[i] - table.time[i - 1] > kPause) return false;
    }
    return true;
  };
  for (const std::size_t before : {2U, 1U, 3U, 0U, 4U}) {
    if (row >= before && one_motion(row - before)) return row - before;
  }
  return table.time.size();
}

// Values at five rows less what the cubic through the other four says at the one of them: weights.
std::array<double, 5> FromCubic(const Values& time, std::size_t first, std::size_t row) {
  std::array<double, 5> weights{};
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const std::size_t at = first + k;
    weights[k] = at == row ? 1.0 : -1.0;
    for (std::size_t other = first; at != row && other < first + 5; ++other) {
      if (other == at || other == row) continue;
      weights[k] *= (time[row] - time[other]) / (time[at] - time[other]);
    }
  }
  return weights;
}

double Applied(const std::array<double, 5>& weights, const Values& values, std::size_t first) {
  double sum = 0.0;
  for (std::size_t k = 0; k < weights.size(); ++k) sum += weights[k] * values[first + k];
  return sum;
}

// Of each reading from what its neighbours say, `unit` times what scatters alike for all; NaN where
// they say nothing.
struct Off {
  Values scatter, unit;
};

Off OffNeighbours(const Table& table, const Values& values) {
  const std::size_t count = values.size();
  Off off{Values(count, std::numeric_limits<double>::quiet_NaN()), Values(count, 1.0)};
  for (std::size_t i = 0; i < count; ++i) {
    if (table.stay[i] >= kStay) {
      const std::size_t last = table.stay_end[i], first = last - table.stay[i];
      if (i == first) {
        const double median = MedianOf({values.begin() + static_cast<std::ptrdiff_t>(first),
                                        values.begin() + static_cast<std::ptrdiff_t>(last)});
        for (std::size_t k = first; k < last; ++k) off.scatter[k] = values[k] - median;
      }
      continue;
    }
    const std::size_t first = FiveAround(table, i);
    if (first == count) continue;
    const auto weights = FromCubic(table.time, first, i);
    // Where the way bends the cubic says nothing of the instruments either.
    const auto bends = [&](const Values& axis) {
      return std::abs(Applied(weights, axis, first)) > kStays;
    };
    if (std::any_of(table.axes.begin(), table.axes.end(), bends)) continue;
    double square = 0.0;
    for (const double weight : weights) square += weight * weight;
    off.unit[i] = std::sqrt(square);
    off.scatter[i] = Applied(weights, values, first) / off.unit[i];
  }
  return off;
}

double ScatterOf(const Values& off) {
  constexpr double kNormal = 1.4826;
  Values sizes;
  for (const double each : off) {
    if (std::isfinite(each)) sizes.push_back(std::abs(each));
  }
  return sizes.empty() ? 0.0 : kNormal * MedianOf(std::move(sizes));
}

double Largest(const Values& off) {
  double most = 0.0;
  for (const double each : off) {
    if (std::abs(each) > most) most = std::abs(each);  // false for NaN
  }
  return most;
}

// A row as its neighbours would have it.
Values Mended(const Values& values, const Off& off, std::size_t row) {
  Values mended = values;
  mended[row] -= off.scatter[row] * off.unit[row];
  return mended;
}

// Where a motion begins or ends its first rows are all off alike when one of them is: that one
// which leaves the others at peace.
std::size_t WorstOf(const Table& table, const Values& values, const Off& off, double most) {
  constexpr double kAlike = 0.999;
  std::vector<std::size_t> alike;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::abs(off.scatter[i]) < kAlike * most || !std::isfinite(off.scatter[i])) continue;
    if (alike.empty() || i < alike.front() + 5) alike.push_back(i);
  }
  if (alike.size() == 1) return alike.front();
  std::size_t worst = alike.front();
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t row : alike) {
    const std::size_t first = row - std::min<std::size_t>(row, 9);
    Values left = OffNeighbours(table, Mended(values, off, row)).scatter;
    left.resize(std::min(left.size(), row + 10));
    left.erase(left.begin(), left.begin() + static_cast<std::ptrdiff_t>(first));
    if (Largest(left) >= least) continue;
    least = Largest(left);
    worst = row;
  }
  return worst;
}

// The worst first, for it makes its neighbours look bad too: it takes their middle meanwhile.
std::vector<std::size_t> OutliersOf(const Table& table, Values values) {
  std::vector<std::size_t> outliers;
  const std::size_t at_most = values.size() / 10;
  Off off = OffNeighbours(table, values);
  const double usual = ScatterOf(off.scatter);
  if (usual == 0.0) return outliers;
  while (outliers.size() < at_most) {
    const double most = Largest(off.scatter);
    if (most < kFar * usual) break;
    outliers.push_back(WorstOf(table, values, off, most));
    values = Mended(values, off, outliers.back());
    off = OffNeighbours(table, values);
    for (const std::size_t known : outliers) off.scatter[known] = 0.0;
  }
  return outliers;
}

// First and last row of the longest stretch of one value; the same when there is none.
std::pair<std::size_t, std::size_t> StuckOf(const Table& table, std::size_t which) {
  const Values& values = table.channels[which].values;
  std::pair<std::size_t, std::size_t> longest{0, 0};
  for (std::size_t first = 0; first < values.size();) {
    std::size_t last = first;
    while (last + 1 < values.size() && values[last + 1] == values[first]) ++last;
    if (last - first > longest.second - longest.first) longest = {first, last};
    first = last + 1;
  }
  const std::size_t first = longest.first, last = longest.second;
  if (last + 1 - first < kLeastStuck) return {0, 0};
  const auto changes = [&](const Channel& other) {
    std::size_t changed = 0;
    for (std::size_t i = first; i < last; ++i) changed += other.values[i + 1] != other.values[i];
    return 2 * changed > last - first;
  };
  const bool others_change = std::any_of(table.channels.begin(), table.channels.end(), changes);
  return others_change ? longest : std::pair<std::size_t, std::size_t>{0, 0};
}

void Flag(recording::Recording& recording, std::size_t row) {
  for (auto& column : recording.columns) {
    if (column.name == "flags") column.values[row] = kFlag;
  }
}

}  // namespace

std::vector<BadData> FlagBadRows(recording::Recording& recording) {
  const Table table = TableOf(recording);
  std::vector<BadData> bad;
  if (table.rows.size() < kLeastStuck) return bad;
  if (!recording.Find("flags")) {
    recording.columns.push_back({"flags", Values(recording.rows(), 0.0)});
  }
  for (std::size_t c = 0; c < table.channels.size(); ++c) {
    const Channel& channel = table.channels[c];
    const auto [first, last] = StuckOf(table, c);
    if (last > first) {
      bad.push_back({"stuck-channel", channel.object, table.time[first], table.time[last],
                     static_cast<int>(last + 1 - first)});
      // The first reading was still one.
      for (std::size_t i = first + 1; i <= last; ++i) Flag(recording, table.rows[i]);
      continue;
    }
    const std::vector<std::size_t> outliers = OutliersOf(table, channel.values);
    if (outliers.empty()) continue;
    const auto [from, to] = std::minmax_element(outliers.begin(), outliers.end());
    bad.push_back({"outliers", channel.object, table.time[*from], table.time[*to],
                   static_cast<int>(outliers.size())});
    for (const std::size_t i : outliers) Flag(recording, table.rows[i]);
  }
  return bad;
}

}  // namespace abbe::diagnosis
