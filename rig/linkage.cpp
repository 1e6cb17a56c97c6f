#include "rig/linkage.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "failure/failure.h"
#include "random/counter_random.h"
#include "rig/streams.h"

namespace abbe::rig {
namespace {

using Eigen::Vector3d;

constexpr double kClosed = 1e-13;  // m
constexpr int kMostRounds = 50;
constexpr std::uint64_t kDrawsOfBase = 6;

// Draws in a fixed order, each number once.
class Draws {
 public:
  Draws(std::uint64_t seed, std::uint64_t stream) : random_(seed, stream) {}
  double Normal(double deviation) { return deviation * random_.Normal(index_++); }
  void Skip(std::uint64_t count) { index_ += count; }

 private:
  random::CounterRandom random_;
  std::uint64_t index_ = 0;
};

std::vector<Harmonic> DrawHarmonics(Draws& draws, const std::vector<int>& orders,
                                    double deviation) {
  std::vector<Harmonic> harmonics;
  harmonics.reserve(orders.size());
  for (const int order : orders) {
    const double sine = draws.Normal(deviation);
    harmonics.push_back({order, sine, draws.Normal(deviation)});
  }
  return harmonics;
}

// A turn about a line that does not pass through the origin, then a shift.
Displacement TurnAbout(const Vector3d& point, const Eigen::Matrix3d& rotation,
                       const Vector3d& shift) {
  return {rotation, point - rotation * point + shift};
}

Displacement TurnAbout(const Vector3d& point, const Vector3d& direction, double angle,
                       const Vector3d& shift) {
  return TurnAbout(point, Eigen::AngleAxisd(angle, direction).toRotationMatrix(), shift);
}

// `carried`: the displacement by the pivots before; afterwards with that of this one.
PivotTruth DrawPivot(const LinkageSettings& settings, std::uint64_t seed, int pivot,
                     const Vector3d& point, const Vector3d& direction, Displacement& carried) {
  Draws draws(seed, kLinkageStream + static_cast<std::uint64_t>(pivot));
  PivotTruth truth;
  const Vector3d first = Vector3d::UnitX();  // across z and y, the two nominal axes
  const Vector3d second = direction.cross(first);
  const double about_first = draws.Normal(settings.pivot_angle);
  const double about_second = draws.Normal(settings.pivot_angle);
  const Eigen::Matrix3d askew =
      Eigen::AngleAxisd(about_first, first) * Eigen::AngleAxisd(about_second, second).matrix();
  const double along_first = draws.Normal(settings.pivot_offset);
  const Vector3d offset = along_first * first + draws.Normal(settings.pivot_offset) * second;
  carried = carried * TurnAbout(point, askew, offset);
  truth.direction = carried.rotation * direction;
  truth.point = carried * point;
  truth.across = {first, second};
  for (auto& run_out : truth.run_out) {
    run_out = DrawHarmonics(draws, settings.bearing_harmonics, settings.bearing);
  }
  truth.encoder_zero = draws.Normal(settings.encoder_offset);
  truth.encoder = DrawHarmonics(draws, {1}, settings.eccentricity);
  for (const Harmonic& h :
       DrawHarmonics(draws, settings.graduation_harmonics, settings.graduation)) {
    truth.encoder.push_back(h);
  }
  truth.give = draws.Normal(settings.compliance);
  return truth;
}

double Sum(const std::vector<Harmonic>& harmonics, double angle) {
  double sum = 0.0;
  for (const Harmonic& harmonic : harmonics) sum += harmonic.At(angle);
  return sum;
}

}  // namespace

double Harmonic::At(double angle) const {
  return sine * std::sin(order * angle) + cosine * std::cos(order * angle);
}

Linkage::Linkage(const LinkageSettings& settings, std::uint64_t seed, const HiddenEffects& hidden,
                 std::uint64_t base)
    : settings_(settings) {
  Draws draws(seed, kLinkageStream + kPivots);
  const double link_1 = settings.link_1 + draws.Normal(settings.link);
  const double link_2 = settings.link_2 + draws.Normal(settings.link);
  const Vector3d elbow(link_1, 0.0, 0.0);
  Displacement carried;
  parts_.pivots = {DrawPivot(settings, seed, 0, Vector3d::Zero(), Vector3d::UnitZ(), carried),
                   DrawPivot(settings, seed, 1, Vector3d::Zero(), Vector3d::UnitY(), carried),
                   DrawPivot(settings, seed, 2, elbow, Vector3d::UnitY(), carried)};
  const double ball_x = draws.Normal(settings.ball);
  ball_ = carried * (elbow + Vector3d(ball_x, draws.Normal(settings.ball), link_2));
  for (double& each : parts_.expansion) each = settings.expansion + draws.Normal(settings.thermal);
  Vector3d place, angles;
  draws.Skip(kDrawsOfBase * base);
  for (double& each : place) each = draws.Normal(settings.base_place);
  for (double& each : angles) each = draws.Normal(settings.base_angle);
  base_ = {FullRotation(angles) * settings.base_rotation, settings.base_position + place};
  down_B_ = base_.rotation.transpose() * settings.down;
  for (const HiddenEffect& effect : hidden) {
    if (effect.entry->in_linkage != nullptr) effect.entry->in_linkage(effect, parts_);
  }
}

Linkage::Posture Linkage::PostureAt(const Vector3d& turns, double temperature) const {
  const double warmth = temperature - settings_.reference_temperature;
  // At zero angles: link 1 along x, link 2 along z; their growth moves all that they carry.
  const double longer_1 =
      Sum(parts_.pivots[0].stretch, turns[0]) + Sum(parts_.pivots[1].stretch, turns[1]);
  const double longer_2 = Sum(parts_.pivots[2].stretch, turns[2]);
  const Vector3d growth_1 =
      (parts_.expansion[0] * warmth * settings_.link_1 + longer_1) * Vector3d::UnitX();
  const Vector3d growth_2 =
      (parts_.expansion[1] * warmth * settings_.link_2 + longer_2) * Vector3d::UnitZ();
  const std::array<Vector3d, kPivots> link = {Vector3d::Zero(), Vector3d::UnitX(),
                                              Vector3d::UnitZ()};
  Posture posture;
  Displacement moved;  // by the pivots before
  for (std::size_t i = 0; i < kPivots; ++i) {
    const PivotTruth& pivot = parts_.pivots[i];
    const double turn = turns[i];
    const Vector3d point = i == 2 ? Vector3d(pivot.point + growth_1) : pivot.point;
    Vector3d shift = Vector3d::Zero();
    for (std::size_t k = 0; k < 2; ++k) shift += Sum(pivot.run_out[k], turn) * pivot.across[k];
    posture.point[i] = moved * (point + shift);
    posture.direction[i] = moved.rotation * pivot.direction;
    const Displacement stiff = moved * TurnAbout(point, pivot.direction, turn, shift);
    // The weight of the link turns it about the pivot: by `give` where it is horizontal.
    const Vector3d torque = (stiff.rotation * link[i]).cross(down_B_);
    const double sag = pivot.give * posture.direction[i].dot(torque);
    moved = moved * TurnAbout(point, pivot.direction, turn + sag, shift);
  }
  posture.ball = moved * (ball_ + growth_1 + growth_2);
  return posture;
}

Vector3d Linkage::BallAt(const Vector3d& turns, double temperature) const {
  return PostureAt(turns, temperature).ball;
}

// The nominal triangle of pivot 2, elbow and ball, by its three sides.
Vector3d Linkage::Guess(const Vector3d& p_B) const {
  const double across = std::hypot(p_B.x(), p_B.y()) * (settings_.reach_over ? -1.0 : 1.0);
  const double distance = p_B.norm();
  const double a = settings_.link_1, b = settings_.link_2;
  const double at_pivot_2 = (a * a + distance * distance - b * b) / (2.0 * a * distance);
  const double at_elbow = (a * a + b * b - distance * distance) / (2.0 * a * b);
  if (!(std::abs(at_pivot_2) < 1.0 && std::abs(at_elbow) < 1.0)) {
    throw InputError(fmt::format(
        "the linkage does not reach the ball {:.1f} mm from pivot 2 with links of {:.1f} and "
        "{:.1f} mm; move linkage.base.position_mm or the path",
        1e3 * distance, 1e3 * a, 1e3 * b));
  }
  // The sense of the links in the plane of the arm: reaching over mirrors it.
  const double side = settings_.elbow_up != settings_.reach_over ? 1.0 : -1.0;
  const double rise = std::atan2(p_B.z(), across);
  const double link_1 = rise + side * std::acos(at_pivot_2);  // above the horizontal
  const double link_2 = link_1 + side * (std::acos(at_elbow) - std::numbers::pi);
  const double arm = std::atan2(p_B.y(), p_B.x()) + (settings_.reach_over ? std::numbers::pi : 0.0);
  // A turn about y lowers x; at zero link 2 points along z.
  return {std::remainder(arm, 2.0 * std::numbers::pi),
          std::remainder(-link_1, 2.0 * std::numbers::pi),
          std::remainder(std::numbers::pi / 2.0 - link_2 + link_1, 2.0 * std::numbers::pi)};
}

Vector3d Linkage::TurnsFor(const Vector3d& p_B, double temperature) const {
  Vector3d turns = Guess(p_B);
  for (int round = 0; round < kMostRounds; ++round) {
    const Posture posture = PostureAt(turns, temperature);
    const Vector3d open = p_B - posture.ball;
    if (open.norm() < kClosed) return turns;
    // The velocity of the ball about each axis; run-out and sag change it by 1e-4 only.
    Eigen::Matrix3d velocity;
    for (std::size_t i = 0; i < kPivots; ++i) {
      velocity.col(i) = posture.direction[i].cross(posture.ball - posture.point[i]);
    }
    turns += velocity.fullPivLu().solve(open);
  }
  throw NumericalError(fmt::format(
      "the loop of the linkage does not close at ({:.3f}, {:.3f}, {:.3f}) mm of its base; keep "
      "away from stretched links and from the axis of pivot 1",
      1e3 * p_B.x(), 1e3 * p_B.y(), 1e3 * p_B.z()));
}

Vector3d Linkage::EncodersAt(const Vector3d& turns) const {
  Vector3d shown;
  for (std::size_t i = 0; i < kPivots; ++i) {
    shown[i] = turns[i] + parts_.pivots[i].encoder_zero + Sum(parts_.pivots[i].encoder, turns[i]);
  }
  return shown;
}

Vector3d Linkage::TurnsForPlace(const Vector3d& p_M, double temperature) const {
  return TurnsFor(base_.rotation.transpose() * (p_M - base_.translation), temperature);
}

Vector3d Linkage::EncodersFor(const Vector3d& p_M, double temperature) const {
  return EncodersAt(TurnsForPlace(p_M, temperature));
}

}  // namespace abbe::rig
