#include "relm/chain_rows.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "failure/failure.h"
#include "geometry/rotation.h"
#include "relm/weights.h"

namespace abbe::relm {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using geometry::Transform;

constexpr double kWholeTurn = 2.0 * std::numbers::pi;
constexpr double kQuarterTurn = std::numbers::pi / 2.0;
constexpr double kRoundedAngle = 1e-12;

using Pose = Transform<double>;

Pose AfterRow(const DenavitHartenbergRow& row) {
  return Pose{geometry::RotationZ(row.theta), Vector3d(0.0, 0.0, row.d)} *
         Pose{geometry::RotationX(row.alpha), Vector3d(row.a, 0.0, 0.0)};
}

double Near(double angle, double nominal) {
  return nominal + std::remainder(angle - nominal, kWholeTurn);
}

bool IsTilt(const DenavitHartenbergRow& row) {
  return row.fixed && row.d == 0.0 && row.a == 0.0 &&
         std::abs(row.theta - kQuarterTurn) < kRoundedAngle;
}

DenavitHartenbergRow TiltBy(double angle) {
  return {.theta = kQuarterTurn, .d = 0.0, .a = 0.0, .alpha = angle, .fixed = true};
}

// A row from one joint to the next, with the tilt that follows it.
struct Step {
  DenavitHartenbergRow row;
  bool parallel = false;
  double tilt = 0.0;  // of axes written parallel

  // The frame of the next joint; theta of its row counts without the tilt's own.
  Pose Frame() const { return AfterRow(row) * Pose{geometry::RotationY(tilt), Vector3d::Zero()}; }
};

// The step from the z axis to `next`, both in the frame of this joint, near `nominal`.
Step StepTo(const JointAxis& next, const Step& nominal) {
  Step step = nominal;
  const Vector3d z = Vector3d::UnitZ(), &along = next.direction;
  if (nominal.parallel) {
    if (std::abs(nominal.row.a) < kRoundedAngle) {
      throw InputError("two joints are written on one line; write the arm as axes");
    }
    const Vector3d at = next.point + along * ((nominal.row.d - next.point.z()) / along.z());
    const double sense = nominal.row.a < 0.0 ? -1.0 : 1.0;
    step.row.theta = Near(std::atan2(sense * at.y(), sense * at.x()), nominal.row.theta);
    step.row.a = sense * std::hypot(at.x(), at.y());
    const Vector3d seen = geometry::RotationZ(-step.row.theta) * along;
    step.row.alpha = Near(std::atan2(-seen.y(), seen.z()), nominal.row.alpha);
    step.tilt = std::asin(seen.x());
    return step;
  }
  const Vector3d across = z.cross(along);
  Vector3d normal = across.normalized();
  double theta = std::atan2(normal.y(), normal.x());
  if (std::abs(std::remainder(theta - nominal.row.theta, kWholeTurn)) > kQuarterTurn) {
    normal = -normal;
    theta += std::numbers::pi;
  }
  step.row.theta = Near(theta, nominal.row.theta);
  const Vector3d beside = normal.cross(along);
  step.row.d = next.point.dot(beside) / z.dot(beside);
  step.row.a = next.point.dot(normal);
  step.row.alpha = Near(std::atan2(normal.dot(across), along.z()), nominal.row.alpha);
  return step;
}

JointAxis In(const Pose& X_FB, const JointAxis& axis) {
  return {X_FB * axis.point, X_FB.R * axis.direction};
}

Vector3d FootOf(const Vector3d& point, const JointAxis& axis) {
  return axis.point + axis.direction * axis.direction.dot(point - axis.point);
}

// Rows as steps: fixed ones before the first joint, a step for each joint but the last, the rest.
struct Steps {
  Pose before;
  std::size_t fixed_before = 0;
  std::vector<Step> steps;
  std::vector<DenavitHartenbergRow> last;  // the last joint's, and fixed ones behind it
};

Steps StepsOf(const std::vector<DenavitHartenbergRow>& rows) {
  Steps all;
  std::size_t i = 0;
  for (; i < rows.size() && rows[i].fixed; ++i) all.before = all.before * AfterRow(rows[i]);
  all.fixed_before = i;
  double taken = 0.0;  // of theta, by a tilt before
  for (; i < rows.size(); ++i) {
    std::size_t next = i + 1;
    while (next < rows.size() && rows[next].fixed) ++next;
    Step step{rows[i], std::abs(std::sin(rows[i].alpha)) < kParallel};
    step.row.theta += taken;
    taken = 0.0;
    if (next == rows.size()) {
      all.last.assign(rows.begin() + i, rows.end());
      all.last.front() = step.row;
      return all;
    }
    if (next > i + 2 || (next == i + 2 && !IsTilt(rows[i + 1]))) {
      throw InputError(fmt::format(
          "row {} of the Denavit-Hartenberg table is fixed between two joints; write the arm as axes",
          i + 2));
    }
    if (next == i + 2) {
      step.parallel = true;
      step.tilt = rows[i + 1].alpha;
      taken = kQuarterTurn;
      ++i;
    }
    all.steps.push_back(step);
  }
  throw InputError("the Denavit-Hartenberg table has no joint");
}

// `frame`, whose z axis lies on a first axis, moved to the one of `axes`; then turned about it and
// shifted along it until the second axis follows it as in `first`.
Pose OnFirst(const std::vector<JointAxis>& axes, const Pose& frame, const Step& first) {
  const Vector3d z = frame.R.col(2);
  const Eigen::Matrix3d turn =
      Eigen::Quaterniond::FromTwoVectors(z, axes[0].direction).toRotationMatrix();
  const Pose on{turn * frame.R, FootOf(frame.p, axes[0])};
  if (axes.size() < 2) return on;
  const Step found = StepTo(In(on.Inverse(), axes[1]), first);
  return on * Pose{geometry::RotationZ(found.row.theta - first.row.theta),
                   Vector3d(0.0, 0.0, found.row.d - first.row.d)};
}

WrittenChain RowsWith(const WrittenChain& nominal, const SerialChain& chain) {
  const Steps steps = StepsOf(nominal.rows);
  const Step none{steps.last.front()};
  const Pose first =
      OnFirst(chain.axes(), steps.before, steps.steps.empty() ? none : steps.steps.front());
  WrittenChain written = nominal;
  written.X_BW = first * steps.before.Inverse();
  written.rows.resize(steps.fixed_before);
  Pose frame = first;
  double taken = 0.0;
  const auto add = [&](DenavitHartenbergRow row) {
    row.theta -= taken;
    taken = 0.0;
    written.rows.push_back(row);
  };
  for (std::size_t i = 0; i < steps.steps.size(); ++i) {
    const Step step = StepTo(In(frame.Inverse(), chain.axes()[i + 1]), steps.steps[i]);
    frame = frame * step.Frame();
    add(step.row);
    if (!step.parallel) continue;
    written.rows.push_back(TiltBy(step.tilt));
    taken = kQuarterTurn;
  }
  add(steps.last.front());
  frame = frame * AfterRow(steps.last.front());
  for (std::size_t i = 1; i < steps.last.size(); ++i) {
    written.rows.push_back(steps.last[i]);
    frame = frame * AfterRow(steps.last[i]);
  }
  written.ball = frame.Inverse() * chain.tip();
  return written;
}

WrittenChain AxesWith(const WrittenChain& nominal, const SerialChain& chain) {
  const auto frame_on = [](const JointAxis& axis) {
    return Pose{
        Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), axis.direction).toRotationMatrix(),
        axis.point};
  };
  WrittenChain written = nominal;
  const Pose was = frame_on(nominal.axes[0]);
  Step first;
  if (nominal.axes.size() > 1) {
    const JointAxis second = In(was.Inverse(), nominal.axes[1]);
    first.parallel = second.direction.head<2>().norm() < kParallel;
    first.row.d = second.point.z();
    first.row.a = 1.0;
    first = StepTo(second, first);
  }
  const Pose now = OnFirst(chain.axes(), was, first);
  written.X_BW = now * was.Inverse();
  const Pose back = written.X_BW.Inverse();
  for (std::size_t i = 0; i < nominal.axes.size(); ++i) {
    const JointAxis axis = In(back, chain.axes()[i]);
    written.axes[i] = {FootOf(nominal.axes[i].point, axis), axis.direction};
  }
  written.ball = back * chain.tip();
  return written;
}

}  // namespace

WrittenChain WrittenChain::Of(const LinkageSettings& settings) {
  if (settings.pivots || !settings.segments.empty()) {
    throw InputError(
        "the corrected geometry is written as Denavit-Hartenberg rows or as axes; state the arm as "
        "form = \"denavit-hartenberg\" or \"axes\" in [linkage]");
  }
  if (!settings.rows.empty()) return {settings.rows, {}, settings.p_nT};
  return {{}, settings.chain.axes(), settings.chain.tip()};
}

WrittenChain WrittenChain::With(const SerialChain& chain) const {
  return rows.empty() ? AxesWith(*this, chain) : RowsWith(*this, chain);
}

SerialChain WrittenChain::Chain() const {
  return rows.empty() ? SerialChain(axes, ball)
                      : SerialChain::FromDenavitHartenberg(rows, {}, ball);
}

Eigen::VectorXd WrittenChain::Numbers() const {
  std::vector<double> numbers;
  for (const DenavitHartenbergRow& row : rows) {
    numbers.insert(numbers.end(), {row.theta, row.d, row.a, row.alpha});
  }
  for (const JointAxis& axis : axes) {
    numbers.insert(numbers.end(), axis.point.begin(), axis.point.end());
    numbers.insert(numbers.end(), axis.direction.begin(), axis.direction.end());
  }
  numbers.insert(numbers.end(), ball.begin(), ball.end());
  return Eigen::Map<Eigen::VectorXd>(numbers.data(), numbers.size());
}

}  // namespace abbe::relm
