#include "diagnosis/invalid_readings.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "diagnosis/neighbour_prediction.h"
#include "recording/good_rows.h"

namespace abbe::diagnosis {
namespace {

using Numbers = std::vector<double>;

constexpr double kStays = 5e-3;      // mm: nearer rows are of one stay
constexpr double kNeighbours = 0.5;  // s: rows farther apart are no neighbours
constexpr std::size_t kStay = 3;     // rows that say where it stands
constexpr std::size_t kMedian = 5;   // rows that have a median worth the name
constexpr std::size_t kAside = 7;    // rows of a stay to either side that say where it stands
constexpr double kPeace = 4.0;       // times the usual scatter: noise alone
constexpr double kFlag = 4.0;        // device error

struct Channel {
  std::string object;
  Numbers values;
};

// What the rows that count have in common, and the channels of the instrument.
struct Table {
  std::vector<std::size_t> rows;
  Numbers time;
  std::vector<Numbers> axes;                // mm
  std::vector<std::size_t> stay_end, stay;  // of each row: the row after its stay, rows in it
  std::vector<int> motion;                  // number of the motion, or the stay, it belongs to
  std::vector<Channel> channels;
};

double MedianOf(Numbers values) {
  const auto middle = values.begin() + (values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

Numbers At(const recording::Recording& recording, const std::string& column,
           const std::vector<std::size_t>& rows) {
  const auto all = recording.Find(column);
  Numbers values;
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
    const auto together = [&](const Numbers& axis) {
      return std::abs(axis[last] - axis[first]) < kStays;
    };
    while (last < table.rows.size() && table.time[last] - table.time[last - 1] < kNeighbours &&
           std::all_of(table.axes.begin(), table.axes.end(), together)) {
      ++last;
    }
    std::fill(table.stay_end.begin() + first, table.stay_end.begin() + last, last);
    std::fill(table.stay.begin() + first, table.stay.begin() + last, last - first);
    first = last;
  }
  table.motion.resize(table.rows.size());
  for (std::size_t i = 1; i < table.rows.size(); ++i) {
    const bool stood = table.stay[i - 1] >= kStay, stands = table.stay[i] >= kStay;
    const bool other = stood || stands || table.time[i] - table.time[i - 1] > kNeighbours;
    table.motion[i] = table.motion[i - 1] + (other ? 1 : 0);
  }
  for (const auto& column : recording.columns) {
    const std::size_t unit = column.name.rfind('_');
    if (!column.name.starts_with("probe_") && !column.name.starts_with("pivot_")) continue;
    table.channels.push_back({column.name.substr(0, unit), At(recording, column.name, table.rows)});
  }
  return table;
}

// How far each reading of a channel stands from what its neighbours say, in units that scatter
// alike for all; NaN where they say nothing, and for what is an outlier already.
class Neighbours {
 public:
  Neighbours(const Table& table, const Numbers& values)
      : table_(table),
        values_(values),
        middle_(values.size()),
        out_(values.size(), false),
        off_(values.size()) {
    for (std::size_t row = 0; row < off_.size(); ++row) {
      const std::size_t end = table.stay_end[row], begin = end - table.stay[row];
      const std::ptrdiff_t first = std::max(begin + kAside, row) - kAside;
      const std::ptrdiff_t last = std::min(end, row + kAside + 1);
      middle_[row] = MedianOf({values.begin() + first, values.begin() + last});
      off_[row] = OffOf(row);
    }
  }

  const Numbers& off() const { return off_; }
  // Whether a reading is an outlier, of which its neighbours take no notice.
  void SetOut(std::size_t row, bool out) {
    out_[row] = out;
    for (std::size_t near = FirstNear(row); near < LastNear(row); ++near) off_[near] = OffOf(near);
  }
  // Whether a channel that stands elsewhere from this reading or the next one on accounts for the
  // rows around it better than one reading that is off; both beside a cubic of time.
  bool IsOfAStep(std::size_t row) const {
    constexpr std::size_t kLeastRows = 7;
    std::vector<std::size_t> rows = Beside(row, -1);
    const std::vector<std::size_t> after = Beside(row, 1);
    if (table_.stay[row] >= kStay || rows.empty() || after.empty()) return false;
    rows.push_back(row);
    rows.insert(rows.end(), after.begin(), after.end());
    if (rows.size() < kLeastRows) return false;
    Eigen::MatrixXd functions(std::ssize(rows), 5);
    Eigen::VectorXd read(std::ssize(rows));
    const double span = std::abs(table_.time[after.back()] - table_.time[row]);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double t = (table_.time[rows[i]] - table_.time[row]) / span;
      functions.row(i).head<4>() << 1.0, t, t * t, t * t * t;
      read[i] = values_[rows[i]];
    }
    const auto left = [&](const auto& is_off) {
      for (std::size_t i = 0; i < rows.size(); ++i) functions(i, 4) = is_off(rows[i]) ? 1.0 : 0.0;
      return (read - functions * functions.householderQr().solve(read)).squaredNorm();
    };
    const double alone = left([&](std::size_t at) { return at == row; });
    return left([&](std::size_t at) { return at >= row; }) < alone ||
           left([&](std::size_t at) { return at > row; }) < alone;
  }
  double LargestNear(std::size_t row) const {
    double most = 0.0;
    for (std::size_t near = FirstNear(row); near < LastNear(row); ++near) {
      if (std::abs(off_[near]) > most) most = std::abs(off_[near]);  // false for NaN
    }
    return most;
  }

 private:
  static constexpr std::size_t kReach = 10;  // rows that may share five with one

  static std::size_t FirstNear(std::size_t row) { return row - std::min(row, kReach); }
  std::size_t LastNear(std::size_t row) const { return std::min(row + kReach + 1, off_.size()); }

  // The next rows of the same motion that are no outliers.
  std::vector<std::size_t> Beside(std::size_t row, std::ptrdiff_t step) const {
    std::vector<std::size_t> beside;
    const std::ptrdiff_t count = values_.size();
    for (auto at = static_cast<std::ptrdiff_t>(row) + step; at >= 0 && at < count; at += step) {
      if (table_.motion[at] != table_.motion[row] || beside.size() == 4) break;
      if (!out_[at]) beside.push_back(at);
    }
    return beside;
  }

  // By the cubic through the four that lie around it as evenly as can be.
  std::optional<Prediction> ByCubic(std::size_t row) const {
    std::vector<std::size_t> before = Beside(row, -1), after = Beside(row, 1);
    for (const std::size_t first : {2U, 1U, 3U, 0U, 4U}) {
      if (before.size() < first || after.size() < 4 - first) continue;
      before.resize(first);
      before.insert(before.end(), after.begin(), after.begin() + (4 - first));
      return Prediction(table_.time, row, std::move(before));
    }
    return std::nullopt;
  }

  // Those of its stay, by their mean.
  double OffTheOthers(std::size_t row) const {
    double sum = 0.0, count = 0.0;
    const std::size_t end = table_.stay_end[row];
    for (std::size_t other = end - table_.stay[row]; other < end; ++other) {
      if (other == row || out_[other]) continue;
      sum += values_[other];
      ++count;
    }
    if (count == 0.0) return std::numeric_limits<double>::quiet_NaN();
    return (values_[row] - sum / count) / std::sqrt(1.0 + 1.0 / count);
  }

  double OffOf(std::size_t row) const {
    if (out_[row]) return std::numeric_limits<double>::quiet_NaN();
    if (table_.stay[row] >= kMedian) return values_[row] - middle_[row];
    if (table_.stay[row] >= kStay) return OffTheOthers(row);
    const std::optional<Prediction> cubic = ByCubic(row);
    if (!cubic) return std::numeric_limits<double>::quiet_NaN();
    // Where the way bends the cubic says nothing of the instruments either.
    const auto bends = [&](const Numbers& axis) { return std::abs(cubic->Off(axis)) > kStays; };
    if (std::any_of(table_.axes.begin(), table_.axes.end(), bends)) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    return cubic->Off(values_) / cubic->Deviation();
  }

  const Table& table_;
  const Numbers& values_;
  Numbers middle_;  // of the rows beside it in its stay
  std::vector<bool> out_;
  Numbers off_;
};

double ScatterOf(const Numbers& off) {
  constexpr double kNormal = 1.4826;
  Numbers sizes;
  for (const double each : off) {
    if (std::isfinite(each)) sizes.push_back(std::abs(each));
  }
  return sizes.empty() ? 0.0 : kNormal * MedianOf(std::move(sizes));
}

std::size_t Worst(const Numbers& off) {
  const auto smaller = [](double a, double b) { return !(std::abs(a) >= std::abs(b)); };
  std::size_t worst = 0;
  for (std::size_t i = 1; i < off.size(); ++i) {
    if (std::isfinite(off[i]) && smaller(off[worst], off[i])) worst = i;
  }
  return worst;
}

// Where a motion begins or ends, rows that share five are all off alike when one or two of them
// are: those which leave the others at peace.
std::vector<std::size_t> OutOf(Neighbours& neighbours, std::size_t worst, double peace) {
  constexpr double kAlike = 0.999;
  std::vector<std::size_t> alike;
  const double most = std::abs(neighbours.off()[worst]);
  const std::size_t last = std::min(worst + 5, neighbours.off().size());
  for (std::size_t i = worst - std::min<std::size_t>(worst, 4); i < last; ++i) {
    if (std::abs(neighbours.off()[i]) >= kAlike * most) alike.push_back(i);
  }
  std::vector<std::size_t> least_rows{worst};
  double least = std::numeric_limits<double>::infinity();
  const auto attempt = [&](const std::vector<std::size_t>& rows) {
    for (const std::size_t row : rows) neighbours.SetOut(row, true);
    const double left = neighbours.LargestNear(rows.front());
    for (const std::size_t row : rows) neighbours.SetOut(row, false);
    if (left >= least) return;
    least = left;
    least_rows = rows;
  };
  if (alike.size() == 1) return alike;
  for (const std::size_t row : alike) attempt({row});
  if (least < peace) return least_rows;
  for (std::size_t i = 0; i < alike.size(); ++i) {
    for (std::size_t j = i + 1; j < alike.size(); ++j) attempt({alike[i], alike[j]});
  }
  return least_rows;
}

// The worst first, for it makes its neighbours look bad too.
std::vector<std::size_t> OutliersOf(const Table& table, const Numbers& values) {
  std::vector<std::size_t> outliers;
  const std::size_t at_most = values.size() / 10;
  Neighbours neighbours(table, values);
  const double usual = ScatterOf(neighbours.off());
  if (usual == 0.0) return outliers;
  while (outliers.size() < at_most) {
    const std::size_t worst = Worst(neighbours.off());
    if (!(std::abs(neighbours.off()[worst]) >= kFar * usual)) break;
    for (const std::size_t row : OutOf(neighbours, worst, kPeace * usual)) {
      neighbours.SetOut(row, true);
      outliers.push_back(row);
    }
  }
  std::erase_if(outliers, [&](std::size_t row) { return neighbours.IsOfAStep(row); });
  return outliers;
}

// First and last row of the longest stretch of one value; the same when there is none.
std::pair<std::size_t, std::size_t> StuckOf(const Table& table, std::size_t which) {
  const Numbers& values = table.channels[which].values;
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

void AddFlags(recording::Recording& recording) {
  if (recording.Find("flags")) return;
  recording.columns.push_back({"flags", Numbers(recording.rows(), 0.0)});
}

void Flag(recording::Recording& recording, std::size_t row) {
  for (auto& column : recording.columns) {
    if (column.name == "flags") column.values[row] = kFlag;
  }
}

}  // namespace

std::vector<InvalidReadings> FlagInvalidReadings(recording::Recording& recording) {
  if (!recording.Find("time_s")) return {};
  const Table table = TableOf(recording);
  std::vector<InvalidReadings> bad;
  if (table.rows.size() < kLeastStuck) return bad;
  AddFlags(recording);
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

simulation::InvalidReadings FlagOutliers(recording::Recording& recording, const std::string& object,
                                         const std::vector<double>& times) {
  AddFlags(recording);
  InvalidReadings found{"outliers", object, times.front(), times.front(), 0};
  const auto clock = recording.Find("time_s");
  for (std::size_t row = 0; row < clock->size(); ++row) {
    if (std::ranges::find(times, (*clock)[row]) == times.end()) continue;
    Flag(recording, row);
    found.from = std::min(found.from, (*clock)[row]);
    found.to = std::max(found.to, (*clock)[row]);
    ++found.count;
  }
  return found;
}

}  // namespace abbe::diagnosis
