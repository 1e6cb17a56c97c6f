#include "simulation/trace_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace abbe::simulation {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

namespace {

constexpr double kGap = 0.5;  // s between rows: nothing is known of the way between

// Whether nothing is known of the way from the row before.
bool Begins(const Trace& trace, Index row) {
  if (row == 0 || trace.pass[row] != trace.pass[row - 1] ||
      trace.direction[row] != trace.direction[row - 1]) {
    return true;
  }
  // Rows of one instant have no speed between them.
  const double since = trace.time[row] - trace.time[row - 1];
  return since > kGap || since <= 0.0;
}

// Where an axis turned or will turn at a steady acceleration, if that is less than `before` seconds
// ago or `after` seconds ahead.
std::optional<double> TurnNear(const Trace& trace, Index axis, Index row, double before,
                               double after) {
  const double velocity = trace.velocity(axis, row), acceleration = trace.acceleration(axis, row);
  if (acceleration == 0.0) return {};
  const double ago = velocity / acceleration;
  if (ago < -after || ago > before) return {};
  return trace.axes(axis, row) - 0.5 * velocity * ago;
}

// How long ago the motion at a row was surely no other, s: half a second, or on a bent path half a
// radian of it.
double FollowedBack(const Trace& trace, Index row) {
  constexpr double kSeconds = 0.5, kRadians = 0.5;
  const double velocity = trace.velocity.col(row).norm();
  const double bent = trace.acceleration.col(row).norm() / velocity;  // rad/s
  return velocity > 0.0 && bent > 0.0 ? std::max(kSeconds, kRadians / bent) : kSeconds;
}

}  // namespace

Derivatives DerivativesOf(const MatrixXd& values, const Trace& trace) {
  Derivatives found{MatrixXd::Zero(values.rows(), values.cols()),
                    MatrixXd::Zero(values.rows(), values.cols())};
  Index first = 0;
  for (Index row = 0; row < values.cols(); ++row) {
    if (Begins(trace, row)) first = row;
    Index last = row;
    while (last + 1 < values.cols() && last < row + 2 && !Begins(trace, last + 1)) ++last;
    if (last - first < 2) continue;
    const Index middle = std::clamp(row, first + 1, last - 1);
    const double before = trace.time[middle] - trace.time[middle - 1];
    const double after = trace.time[middle + 1] - trace.time[middle];
    const VectorXd rise = (values.col(middle) - values.col(middle - 1)) / before;
    const VectorXd next = (values.col(middle + 1) - values.col(middle)) / after;
    found.second.col(row) = 2.0 * (next - rise) / (before + after);
    found.first.col(row) = (rise * after + next * before) / (before + after) +
                           found.second.col(row) * (trace.time[row] - trace.time[middle]);
  }
  return found;
}

RowVectorXd HeadingOf(const RowVectorXd& position, double band) {
  RowVectorXd heading = RowVectorXd::Zero(position.size());
  if (position.size() == 0) return heading;
  double extreme = position[0], now = 0.0;
  Index first = position.size();
  for (Index row = 1; row < position.size(); ++row) {
    const double moved = position[row] - extreme;
    if (moved * now > 0.0 || (now == 0.0 && std::abs(moved) > band)) {
      if (now == 0.0) first = row;
      now = moved > 0.0 ? 1.0 : -1.0;
      extreme = position[row];
    } else if (moved * now < -0.0 && std::abs(moved) > band) {
      now = -now;
      extreme = position[row];
    }
    heading[row] = now;
  }
  if (first < position.size()) heading.head(first).setConstant(heading[first]);
  return heading;
}

Eigen::Matrix3Xd HeadingsOf(const Eigen::Matrix3Xd& path) {
  Eigen::Matrix3Xd headings(3, path.cols());
  for (Index axis = 0; axis < 3; ++axis) {
    headings.row(axis) = HeadingOf(path.row(axis), kAxisBand);
  }
  return headings;
}

RowVectorXd HeadingOfAxis(const Trace& trace, Index axis) {
  RowVectorXd heading = HeadingOf(trace.axes.row(axis), kAxisBand);
  for (Index row = 0; row < heading.size(); ++row) {
    const Index from = Begins(trace, row) ? row : row - 1;
    if (from + 1 >= heading.size() || Begins(trace, from + 1)) continue;
    const double way = trace.velocity(axis, row) * (trace.time[from + 1] - trace.time[from]);
    if (std::abs(way) > kAxisBand) heading[row] = way > 0.0 ? 1.0 : -1.0;
  }
  return heading;
}

RowVectorXd SinceReversal(const Trace& trace, Index axis, double beyond) {
  const RowVectorXd& position = trace.axes.row(axis);
  RowVectorXd since = RowVectorXd::Constant(position.size(), kLongAgo);
  std::optional<double> turned, turns;  // it has; it will before the next row
  for (Index row = 0; row < position.size(); ++row) {
    if (trace.acceleration(axis, row) != 0.0 && Begins(trace, row)) {
      turned = TurnNear(trace, axis, row, FollowedBack(trace, row), 0.0);
      if (!turned && row + 1 < position.size()) {
        turns = TurnNear(trace, axis, row, 0.0, trace.time[row + 1] - trace.time[row]);
      }
    } else if (turns) {
      turned = std::exchange(turns, std::nullopt);
    } else if (row > 0 && trace.heading(axis, row) != trace.heading(axis, row - 1)) {
      turned = TurnNear(trace, axis, row, trace.time[row] - trace.time[row - 1], 0.0);
      if (!turned) turned = position[row - 1] + beyond * trace.heading(axis, row - 1);
    }
    if (turned) since[row] = std::abs(position[row] - *turned);
  }
  return since;
}

namespace {

// What is driven through a play. `shown`: what is known is not the input, but the input less what
// the output stays behind.
class Play {
 public:
  Play(WidthAt width, bool shown, double at)
      : width_(std::move(width)), shown_(shown), in_(at), out_(at) {}

  void Begin(double at) { in_ = out_ = at; }
  void Follow(double at) {
    const double half = 0.5 * width_(at);
    in_ = shown_ ? std::clamp(0.5 * (at + out_), at - half, at + half) : at;
    out_ = std::clamp(out_, in_ - half, in_ + half);
  }
  double behind() const { return out_ - in_; }

 private:
  WidthAt width_;
  bool shown_;
  double in_, out_;
};

// The way from one row to the next as a cubic, by its slopes at both ends in ways of a step: at a
// corner, where what moves comes to a stand, the slopes of neighbours would take it beyond and
// back.
std::pair<double, double> SlopesOf(double step, double start, double end) {
  constexpr double kSteepest = 3.0;  // steps: a cubic with less does not turn (Fritsch and Carlson)
  if (start * end < 0.0 && std::min(std::abs(start), std::abs(end)) > kAxisBand) {
    return {start, end};  // it turns between the two
  }
  const auto limited = [&](double slope) {
    return slope * step <= 0.0
               ? 0.0
               : std::copysign(std::min(std::abs(slope), kSteepest * std::abs(step)), step);
  };
  return {limited(start), limited(end)};
}

// Whether the axes come from rest with the first row of a recording: they all gather way at once,
// and would have stood shortly before.
bool FromRest(const Trace& trace, Index row) {
  constexpr double kShortly = 0.3, kStood = 0.1;  // s; of the speed
  if (row > 0) return false;
  const Eigen::Vector3d velocity = trace.velocity.col(row), gain = trace.acceleration.col(row);
  if (gain.isZero(0.0)) return false;
  const double ago = velocity.dot(gain) / gain.squaredNorm();
  return ago >= 0.0 && ago < kShortly && (velocity - ago * gain).norm() <= kStood * velocity.norm();
}

// The motion before a pass is continued backwards from its beginning; between two rows the way is a
// cubic, between two that stand a straight line and beside it `aside`.
RowVectorXd Follow(Play play, const RowVectorXd& position, const Trace& trace,
                   const MatrixXd& aside) {
  constexpr double kBefore = 0.5;  // s
  const Derivatives motion = DerivativesOf(position, trace);
  RowVectorXd behind(position.size());
  for (Index row = 0; row < position.size(); ++row) {
    const double velocity = motion.first(0, row), acceleration = motion.second(0, row);
    const bool moves = velocity != 0.0 || acceleration != 0.0;
    if (moves && FromRest(trace, row)) {
      play.Begin(position[row]);
    } else if (moves && Begins(trace, row)) {
      play.Begin(position[row] - kBefore * velocity + 0.5 * kBefore * kBefore * acceleration);
      for (int step = kWaySteps; step > 0; --step) {
        const double ago = kBefore * step / kWaySteps;
        play.Follow(position[row] - ago * velocity + 0.5 * ago * ago * acceleration);
      }
    } else if (moves) {
      const double seconds = trace.time[row] - trace.time[row - 1];
      const double from = position[row - 1], to = position[row];
      const auto [start, end] =
          SlopesOf(to - from, motion.first(0, row - 1) * seconds, velocity * seconds);
      for (int step = 1; step < kWaySteps; ++step) {
        const double s = static_cast<double>(step) / kWaySteps, r = 1.0 - s;
        play.Follow(r * r * (1.0 + 2.0 * s) * from + s * s * (1.0 + 2.0 * r) * to +
                    s * r * r * start - s * s * r * end);
      }
    } else if (row > 0 && aside.size() > 0) {
      for (int step = 1; step < kWaySteps; ++step) {
        const double s = static_cast<double>(step) / kWaySteps;
        play.Follow((1.0 - s) * position[row - 1] + s * position[row] + aside(step, row));
      }
    }
    play.Follow(position[row]);
    behind[row] = play.behind();
  }
  return behind;
}

}  // namespace

RowVectorXd PlayOf(const RowVectorXd& position, const Trace& trace, const WidthAt& width) {
  constexpr double kNone = 1e-12;  // m
  const auto some = [&](double at) { return std::max(width(at), kNone); };
  const RowVectorXd behind = Follow(Play(some, false, position[0]), position, trace, {});
  return behind.cwiseQuotient(position.unaryExpr(some));
}

namespace {

// The cubic through four in their times.
double CubicAt(double time, const std::array<double, 4>& times,
               const std::array<double, 4>& values) {
  double sum = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    double weight = 1.0;
    for (std::size_t other = 0; other < 4; ++other) {
      if (other != k) weight *= (time - times[other]) / (times[k] - times[other]);
    }
    sum += weight * values[k];
  }
  return sum;
}

}  // namespace

RowVectorXd LaggingPlayOf(const RowVectorXd& shown, const RowVectorXd& heading, const Trace& trace,
                          double width) {
  constexpr double kStands = 0.05;  // of the width: less is no motion of the output
  RowVectorXd behind = -0.5 * heading;
  const Index rows = shown.size();
  for (Index turned = 1; turned < rows; ++turned) {
    const double sense = heading[turned - 1];
    if (heading[turned] == sense || sense == 0.0) continue;
    // From the extreme on back and forth as long as it stands there.
    Index extreme = turned;
    while (extreme > 0 && heading[extreme - 1] == sense && !Begins(trace, extreme) &&
           sense * (shown[extreme - 1] - shown[turned]) > 0.0 &&
           sense * (shown[extreme - 1] - shown[extreme]) >= 0.0) {
      --extreme;
    }
    const auto stands = [&](Index row) {
      return std::abs(shown[row] - shown[extreme]) < kStands * width;
    };
    Index first = extreme, last = extreme;
    while (first > 0 && !Begins(trace, first) && stands(first - 1)) --first;
    while (last + 1 < rows && !Begins(trace, last + 1) && stands(last + 1)) ++last;
    if (first < 2 || last + 2 >= rows || Begins(trace, first) || Begins(trace, first - 1) ||
        Begins(trace, last + 1) || Begins(trace, last + 2)) {
      continue;
    }
    const std::array<Index, 4> beside{first - 2, first - 1, last + 1, last + 2};
    std::array<double, 4> times{}, inputs{};
    for (std::size_t k = 0; k < 4; ++k) {
      times[k] = trace.time[beside[k]];
      inputs[k] = shown[beside[k]] + (k < 2 ? 0.5 : -0.5) * sense * width;
    }
    for (Index row = first; row <= last; ++row) {
      const double input = CubicAt(trace.time[row], times, inputs);
      behind[row] = std::clamp((shown[row] - input) / width, -0.5, 0.5);
    }
    // Rows that had come back before the turn was noticed.
    for (Index row = last + 1; row < turned; ++row) behind[row] = 0.5 * sense;
  }
  return behind;
}

RowVectorXd ShownPlayOf(const RowVectorXd& shown, const Trace& trace, double width,
                        const MatrixXd& aside) {
  return Follow(Play([&](double) { return width; }, true, shown[0]), shown, trace, aside) / width;
}

}  // namespace abbe::simulation
