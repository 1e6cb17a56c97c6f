#include "investigate/control_program.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "failure/failure.h"

namespace abbe::investigate {
namespace {

using Eigen::Vector3d;

// Parentheses end a comment.
std::string Comment(std::string text) {
  std::ranges::replace(text, '(', '[');
  std::ranges::replace(text, ')', ']');
  std::ranges::replace(text, '\n', ' ');
  return fmt::format("({})\n", text);
}

struct Row {
  Vector3d place;  // mm
  double time, pass, direction;

  bool IsOfOneMotion(const Row& other) const {
    return pass == other.pass && direction == other.direction;
  }
};

std::vector<Row> RowsOf(const recording::Recording& path) {
  const auto x = path.At("x_mm"), y = path.At("y_mm"), z = path.At("z_mm");
  const auto time = path.At("time_s"), pass = path.At("pass"), direction = path.At("direction");
  std::vector<Row> rows(x.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i] = {{x[i], y[i], z[i]}, time[i], pass[i], direction[i]};
  }
  return rows;
}

double FeedOf(const recording::Recording& path) {
  constexpr double kUsual = 600.0;  // mm/min, of a path that states none
  const auto feed = path.Find("feed_mm_min");
  const double most = feed && !feed->empty() ? std::ranges::max(*feed) : 0.0;
  return most > 0.0 ? most : kUsual;
}

// No minus before a zero.
double Written(double place) { return std::abs(place) < 5e-6 ? 0.0 : place; }

// Each motion along a closed path with a quarter of itself before and after: all axes have moved
// before it counts.
std::vector<Row> WithRunIns(const std::vector<Row>& rows) {
  std::vector<Row> all;
  for (std::size_t first = 0, last = 0; first < rows.size(); first = last) {
    while (last < rows.size() && rows[last].IsOfOneMotion(rows[first])) ++last;
    const auto begin = rows.begin() + first, end = rows.begin() + last;
    const std::ptrdiff_t count = end - begin;
    constexpr std::ptrdiff_t kFewest = 4;
    const double step = count > 1 ? (begin[1].place - begin[0].place).norm() : 0.0;
    const bool is_closed = count > kFewest && step > 0.0 &&
                           (begin[count - 1].place - begin[0].place).norm() < 2 * step;
    if (is_closed) all.insert(all.end(), end - count / 4, end);
    all.insert(all.end(), begin, end);
    if (is_closed) all.insert(all.end(), begin, begin + count / 4);
  }
  return all;
}

}  // namespace

std::string ControlProgram(const recording::Recording& path, const std::string& title) {
  constexpr double kLeastStand = 0.5, kTurn = 1.0;  // s
  const std::vector<Row> rows = RowsOf(path);
  if (rows.empty()) throw InputError(fmt::format("{}: a path without rows", path.name));
  std::string text = Comment(title) + Comment("written by abbe: look for collisions first") +
                     "G17 G21 G90 G94\nG64 P0.002\n" + fmt::format("F{:.6g}\n", FeedOf(path));
  const std::vector<Row> all = WithRunIns(rows);
  for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
    while (last < all.size() && all[last].place == all[first].place &&
           all[last].IsOfOneMotion(all[first])) {
      ++last;
    }
    const Vector3d at = all[first].place.unaryExpr([](double each) { return Written(each); });
    text += fmt::format("G1 X{:.5f} Y{:.5f} Z{:.5f}\n", at.x(), at.y(), at.z());
    if (last - first > 1) {
      const double stand = all[last - 1].time - all[first].time;
      text += fmt::format("G4 P{:.3f}\n", std::max(stand, kLeastStand));
    } else if (last == all.size() || !all[last].IsOfOneMotion(all[first])) {
      text += fmt::format("G4 P{:.3f}\n", kTurn);
    }
  }
  return text + "M2\n";
}

}  // namespace abbe::investigate
