#include "fusion/near_copy.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "simulation/kinds.h"

namespace abbe::fusion {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using recording::Recording;

constexpr std::array<std::string_view, 3> kAxisColumns{"x_mm", "y_mm", "z_mm"};
constexpr Index kOfGroup = 4;       // rows
constexpr Index kGroupsTried = 40;  // where a start is tried
constexpr int kFirstRows = 4;       // of a stay, at which a part or every other row may begin
constexpr int kLater = 12;          // groups
constexpr double kSharedLeast = 0.4, kLeastSigma = 10.0, kSameTime = 0.3;  // of a step
constexpr double kFewestSigns = 200.0;
constexpr double kSameReading = 1e-11;  // of the largest

// Neither where, when and how it was measured nor what is known of it.
bool IsReading(std::string_view name, const simulation::RunKind& kind) {
  static constexpr std::array kOther{"time_s", "pass", "direction", "flags",
                                     "setup",  "hole", "shaft_deg", "shaft_rad"};
  static constexpr std::array kBegins{"approach_", "feed_", "plate_", "u_", "temp_"};
  if (std::ranges::find(kAxisColumns, name) != kAxisColumns.end()) return kind.ReadsAxes();
  return std::ranges::find(kOther, name) == kOther.end() &&
         std::ranges::none_of(kBegins, [&](const char* begin) { return name.starts_with(begin); });
}

// One entry a channel that both have.
using Channels = std::vector<std::pair<std::span<const double>, std::span<const double>>>;

Channels SharedChannels(const Recording& one, const Recording& other,
                        const simulation::RunKind& kind) {
  Channels channels;
  for (const recording::Column& column : one.columns) {
    if (!IsReading(column.name, kind)) continue;
    if (const auto same = other.Find(column.name)) channels.emplace_back(column.values, *same);
  }
  return channels;
}

bool SameButAConstant(std::span<const double> a, std::span<const double> b) {
  double largest = 0.0;
  for (const double value : a) largest = std::fmax(largest, std::abs(value));
  std::optional<double> constant;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::isnan(a[i]) && std::isnan(b[i])) continue;
    const double apart = b[i] - a[i];
    if (!constant) constant = apart;
    if (!(std::abs(apart - *constant) <= kSameReading * largest)) return false;
  }
  return true;
}

bool SameReadings(const Channels& channels) {
  std::set<std::pair<std::size_t, double>> values;
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const auto& [a, b] = channels[c];
    if (a.size() != b.size() || !SameButAConstant(a, b)) return false;
    for (const double value : a) {
      if (values.size() < kDifferent && std::isfinite(value)) values.emplace(c, value);
    }
  }
  return values.size() >= kDifferent;
}

// Where a recording stands still: the first row of each stay, and those of its groups.
struct Stays {
  std::vector<std::size_t> first, groups;
};

Stays StaysOf(const Recording& recording) {
  std::vector<std::span<const double>> axes;
  for (const std::string_view name : kAxisColumns) {
    if (const auto axis = recording.Find(name)) axes.push_back(*axis);
  }
  const auto flags = recording.Find("flags");
  Stays stays;
  std::size_t begin = 0;
  for (std::size_t row = 1; row <= recording.rows(); ++row) {
    const auto left = [&](std::span<const double> axis) {
      return !(std::abs(axis[row] - axis[begin]) <= kStill);
    };
    if (row < recording.rows() && std::ranges::none_of(axes, left)) continue;
    if (row - begin >= kOfGroup) stays.first.push_back(begin);
    for (std::size_t group = begin; group + kOfGroup <= row; group += kOfGroup) {
      const auto bad = [](double flag) { return flag != 0.0; };
      if (flags && std::ranges::any_of(flags->subspan(group, kOfGroup), bad)) continue;
      stays.groups.push_back(group);
    }
    begin = row;
  }
  return stays;
}

using GroupRows = std::array<std::size_t, kOfGroup>;

GroupRows RowsFrom(std::size_t first) {
  GroupRows rows;
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = first + i;
  return rows;
}

// The readings of a group without their means, in an orthonormal basis: three entries a channel.
template <typename ReadingsOf>
VectorXd WithoutMeans(const GroupRows& rows, Index channels, const ReadingsOf& readings_of) {
  static const MatrixXd kBasis =
      (MatrixXd(3, 4) << 0.5, 0.5, -0.5, -0.5, 0.5, -0.5, 0.5, -0.5, 0.5, -0.5, -0.5, 0.5)
          .finished();
  VectorXd left(3 * channels);
  for (Index c = 0; c < channels; ++c) {
    Eigen::Vector4d four;
    for (Index i = 0; i < kOfGroup; ++i) four[i] = readings_of(c)[rows[i]];
    left.segment<3>(3 * c) = kBasis * four;
  }
  return left;
}

// The directions of least variance of the groups, one a row.
MatrixXd LeastDirections(const MatrixXd& groups) {
  const VectorXd scale = (groups.rowwise().squaredNorm() / groups.cols()).cwiseSqrt();
  std::vector<Index> alive;
  for (Index i = 0; i < scale.size(); ++i) {
    if (scale[i] > 0.0 && std::isfinite(scale[i])) alive.push_back(i);
  }
  if (alive.empty()) return MatrixXd::Zero(0, groups.rows());
  const VectorXd by = scale(alive).cwiseInverse();
  const MatrixXd scaled = by.asDiagonal() * groups(alive, Eigen::all);
  const MatrixXd moments = scaled * scaled.transpose();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(moments);
  const Index kept = (std::ssize(alive) + 2) / 3;
  MatrixXd directions = MatrixXd::Zero(kept, groups.rows());
  const MatrixXd least = eigen.eigenvectors().leftCols(kept).transpose() * by.asDiagonal();
  directions(Eigen::all, alive) = least;
  return directions;
}

// How many signs are equal, less those that are not, and how many there are.
struct Signs {
  double sum = 0.0, count = 0.0;

  void Add(const VectorXd& a, const VectorXd& b) {
    for (Index i = 0; i < a.size(); ++i) {
      const double product = a[i] * b[i];
      if (product == 0.0 || !std::isfinite(product)) continue;
      sum += product > 0.0 ? 1.0 : -1.0;
      count += 1.0;
    }
  }
  double Share() const { return count > 0.0 ? sum / count : 0.0; }
  double Sigma() const { return count > 0.0 ? sum / std::sqrt(count) : 0.0; }
};

// Looks for `part`, the one with fewer rows, in `whole`.
class CopySearch {
 public:
  CopySearch(const Recording& part, const Recording& whole, const Channels& channels)
      : channels_(channels),
        t_(part.At("time_s")),
        t_whole_(whole.At("time_s")),
        stays_(StaysOf(part)),
        stays_whole_(StaysOf(whole)) {
    for (const std::string_view name : kAxisColumns) {
      const auto axis = part.Find(name), same = whole.Find(name);
      if (axis && same) axes_.emplace_back(*axis, *same);
    }
    const Index count = std::ssize(stays_.groups), C = std::ssize(channels_);
    if (count == 0 || stays_.first.empty() || stays_whole_.first.empty()) return;
    MatrixXd groups(3 * C, count);
    for (Index g = 0; g < count; ++g) {
      groups.col(g) =
          WithoutMeans(RowsFrom(stays_.groups[g]), C, [&](Index c) { return channels_[c].first; });
    }
    least_ = LeastDirections(groups);
    noise_ = least_ * groups;
    std::vector<double> steps;
    for (const std::size_t first : stays_whole_.first) {
      steps.push_back(t_whole_[first + 1] - t_whole_[first]);
    }
    std::ranges::nth_element(steps, steps.begin() + std::ssize(steps) / 2);
    same_time_ = kSameTime * steps[steps.size() / 2];
  }

  std::optional<double> Shared() const {
    if (noise_.size() < kFewestSigns || !(same_time_ > 0.0)) return std::nullopt;
    const double start = BestStart();
    const std::vector<VectorXd> found = NoiseOfWhole(start, 0, noise_.cols());
    const Signs now = SignsAt(found, 0);
    if (now.count < kFewestSigns || now.Share() < kSharedLeast || now.Sigma() < kLeastSigma) {
      return std::nullopt;
    }
    for (int later = 1; later <= kLater; ++later) {
      if (2.0 * std::abs(SignsAt(found, later).Share()) > now.Share()) return std::nullopt;
    }
    return std::sin(now.Share() * std::numbers::pi / 2.0);
  }

 private:
  // The groups of the part beside those in `found` of the whole, which are empty where it has none.
  Signs SignsAt(const std::vector<VectorXd>& found, int later) const {
    Signs signs;
    for (Index g = 0; g + later < std::ssize(found); ++g) {
      const VectorXd& other = found[g + later];
      if (other.size() > 0) signs.Add(noise_.col(g), other);
    }
    return signs;
  }

  std::optional<GroupRows> RowsAt(double start, std::size_t first) const {
    GroupRows rows;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double time = t_[first + i] + start;
      const auto at = std::ranges::lower_bound(t_whole_, time - same_time_);
      if (at == t_whole_.end() || *at > time + same_time_) return std::nullopt;
      rows[i] = at - t_whole_.begin();
      for (const auto& [axis, axis_whole] : axes_) {
        if (!(std::abs(axis[first + i] - axis_whole[rows[i]]) <= kStill)) return std::nullopt;
      }
    }
    return rows;
  }

  std::vector<VectorXd> NoiseOfWhole(double start, Index from, Index to) const {
    std::vector<VectorXd> noise(to - from);
    for (Index g = from; g < to; ++g) {
      const auto rows = RowsAt(start, stays_.groups[g]);
      if (!rows) continue;
      const VectorXd group =
          WithoutMeans(*rows, std::ssize(channels_), [&](Index c) { return channels_[c].second; });
      noise[g - from] = least_ * group;
    }
    return noise;
  }

  // The start of the part in the time of the whole at which most signs are equal, tried in its
  // middle.
  double BestStart() const {
    const std::size_t middle = stays_.first[stays_.first.size() / 2];
    const Index groups = noise_.cols();
    const Index near = std::ranges::lower_bound(stays_.groups, middle) - stays_.groups.begin();
    const Index from = std::max<Index>(0, std::min(near, groups - kGroupsTried));
    const Index to = std::min(groups, from + kGroupsTried);
    double best = -1.0, start = 0.0;
    for (const std::size_t first : stays_whole_.first) {
      for (std::size_t row = first; row < first + kFirstRows; ++row) {
        const double here = t_whole_[row] - t_[middle];
        const std::vector<VectorXd> found = NoiseOfWhole(here, from, to);
        Signs signs;
        for (Index g = from; g < to; ++g) {
          if (found[g - from].size() > 0) signs.Add(noise_.col(g), found[g - from]);
        }
        if (signs.Sigma() > best) {
          best = signs.Sigma();
          start = here;
        }
      }
    }
    return start;
  }

  const Channels& channels_;  // of the part, of the whole
  Channels axes_;
  std::span<const double> t_, t_whole_;
  Stays stays_, stays_whole_;
  MatrixXd least_, noise_;  // of the part, one column a group
  double same_time_ = 0.0;
};

}  // namespace

std::optional<double> SharedNoise(const Recording& one, const Recording& other) {
  if (other.rows() < one.rows()) return SharedNoise(other, one);
  if (one.rows() == 0) return std::nullopt;
  const simulation::RunKind& kind = simulation::KindOf(one);
  if (&kind != &simulation::KindOf(other)) return std::nullopt;
  const Channels channels = SharedChannels(one, other, kind);
  if (channels.empty()) return std::nullopt;
  if (SameReadings(channels)) return 1.0;
  const bool stays = kind.Stands() || (one.Find("x_mm") && !kind.ReadsAxes());
  if (!stays || !one.Find("time_s") || !other.Find("time_s")) return std::nullopt;
  return CopySearch(one, other, channels).Shared();
}

}  // namespace abbe::fusion
