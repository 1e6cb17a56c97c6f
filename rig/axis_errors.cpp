#include "rig/axis_errors.h"

#include "random/counter_random.h"
#include "rig/streams.h"

namespace abbe::rig {
namespace {

bool IsStraightness(int axis, int motion) { return motion < 3 && motion != axis; }

// The standard deviation of one function: roll turns about the axis itself; pitch is the turn that
// lifts the nose of the carriage (about y for X and Z, about x for Y), yaw the remaining one.
double DeviationOf(const ErrorPopulation& population, int axis, int motion) {
  if (motion < 3) return motion == axis ? population.positioning : population.straightness;
  const int about = motion - 3;
  if (about == axis) return population.roll;
  const int pitch_about = axis == 1 ? 0 : 1;
  return about == pitch_about ? population.pitch : population.yaw;
}

// The slope of the least-squares line over [low, high], by the midpoint rule on cells that are fine
// against the correlation length.
double Slope(const GaussianProcess& function, double low, double high, double smoothness) {
  const int cells = std::max(400, static_cast<int>(40.0 * (high - low) / smoothness));
  const double middle = 0.5 * (low + high);
  double product = 0.0, square = 0.0;
  for (int i = 0; i < cells; ++i) {
    const double x = low + (high - low) * (i + 0.5) / cells;
    product += (x - middle) * function(x);
    square += (x - middle) * (x - middle);
  }
  return product / square;
}

}  // namespace

std::string MotionName(int axis, int motion) {
  return {'E', "XYZABC"[motion], static_cast<char>('X' + axis)};
}

AxisErrors::AxisErrors(const RigSettings& settings, int axis, std::uint64_t seed)
    : axis_(axis),
      sense_(settings.sense[axis]),
      smoothness_(settings.population.smoothness),
      low_(sense_ * (sense_ > 0.0 ? settings.travels[axis].first : settings.travels[axis].last)),
      high_(sense_ * (sense_ > 0.0 ? settings.travels[axis].last : settings.travels[axis].first)),
      scale_(settings.population.scale * random::CounterRandom(seed, kScaleStream).Normal(axis)) {
  for (int motion = 0; motion < kMotions; ++motion) {
    const auto stream = kErrorStream + static_cast<std::uint64_t>(kMotions * axis + motion);
    functions_.emplace_back(random::CounterRandom(seed, stream),
                            DeviationOf(settings.population, axis, motion), smoothness_, low_,
                            high_);
    offsets_[motion] = functions_[motion](low_);
    if (IsStraightness(axis, motion) && high_ > low_) {
      slopes_[motion] = Slope(functions_[motion], low_, high_, smoothness_);
    }
    if (motion == axis) slopes_[motion] = -scale_;
  }
}

Motions AxisErrors::At(double position) const {
  const double place = sense_ * position;
  const BellWindow window(place, smoothness_);
  Motions errors;
  for (int motion = 0; motion < kMotions; ++motion) {
    errors[motion] =
        functions_[motion].At(window) - offsets_[motion] - slopes_[motion] * (place - low_);
  }
  if (high_ > low_) {
    const double s = (place - low_) / (high_ - low_);
    errors += bends_ * Eigen::Vector3d(s, s * s, s * s * s);
  }
  errors[axis_] *= sense_;
  return errors;
}

void AxisErrors::Add(const AxisErrors& more, double share) {
  for (int motion = 0; motion < kMotions; ++motion) {
    functions_[motion].Add(more.functions_[motion], share);
  }
  offsets_ += share * more.offsets_;
  slopes_ += share * more.slopes_;
  scale_ += share * more.scale_;
}

void AxisErrors::Warm(const ErrorPopulation& by_kelvin, std::uint64_t seed, double warmer) {
  const random::CounterRandom random(seed, kResponseStream);
  for (int motion = 0; motion < kMotions; ++motion) {
    const auto index = static_cast<std::uint64_t>(12 * axis_ + 2 * motion);
    const double size = DeviationOf(by_kelvin, axis_, motion);
    const double first = warmer * random.Normal(index), second = warmer * random.Normal(index + 1);
    if (IsStraightness(axis_, motion)) {
      bends_.row(motion) += size * Eigen::RowVector3d(-first - 0.9 * second, first, second);
    } else {
      const double growth = motion == axis_ ? by_kelvin.scale * (high_ - low_) : size;
      bends_.row(motion) += Eigen::RowVector3d(growth * first, size * second, 0.0);
    }
  }
}

Squareness Squareness::Draw(const RigSettings& settings, std::uint64_t seed) {
  const random::CounterRandom random(seed, kSquarenessStream);
  const double sd = settings.population.squareness;
  return {sd * random.Normal(0), sd * random.Normal(1), sd * random.Normal(2)};
}

Eigen::Vector3d Squareness::LineOf(int axis) const {
  if (axis == 0) return Eigen::Vector3d::UnitX();
  if (axis == 1) return FullRotation(0.0, 0.0, c0y) * Eigen::Vector3d::UnitY();
  return FullRotation(a0z, b0z, 0.0) * Eigen::Vector3d::UnitZ();
}

Displacement CarriageDisplacement(const Eigen::Vector3d& line, const Eigen::Vector3d& reference,
                                  double position, const Motions& errors) {
  const Eigen::Matrix3d rotation = FullRotation(errors.tail<3>());
  return {rotation, reference - rotation * reference + position * line + errors.head<3>()};
}

}  // namespace abbe::rig
