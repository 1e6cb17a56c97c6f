// Every small motion of every axis of any chain, and the errors by encoders, bearings, gravity and
// temperature.

#include <cmath>

#include "relm/error_models.h"
#include "relm/model_builder.h"
#include "relm/weights.h"

namespace abbe::relm {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double kLeastAcross = 1e-9;         // m
constexpr double kStandardGravity = 9.80665;  // m/s^2

// The coordinate direction nearest to perpendicular to `axis`, made perpendicular.
Vector3d AnyAcross(const Vector3d& axis) {
  Index smallest = 0;
  axis.cwiseAbs().minCoeff(&smallest);
  const Vector3d e = Vector3d::Unit(smallest);
  return (e - axis * axis.dot(e)).normalized();
}

Vector3d Across(const Vector3d& axis, const Vector3d& preferred) {
  const Vector3d across = preferred - axis * axis.dot(preferred);
  return across.norm() > kLeastAcross ? across.normalized() : AnyAcross(axis);
}

struct PivotMotions {
  int tilt_u, tilt_v, shift_u, shift_v, turn;
  int growth = -1;  // along the link after the pivot
  double shift_u_sd;
};

PivotMotions AddPivot(const LinkageSettings& settings, Index joint, MotionChain& motions) {
  const auto& [point, axis] = settings.chain.axes()[joint];
  const Vector3d arriving = joint > 0 ? settings.chain.Link(joint - 1) : Vector3d::Zero();
  const Vector3d u = Across(axis, arriving), v = axis.cross(u);
  PivotMotions pivot{};
  pivot.tilt_u = motions.Turn(point, u);
  pivot.tilt_v = motions.Turn(point, v);
  pivot.shift_u = motions.Shift(u);
  pivot.shift_v = motions.Shift(v);
  pivot.turn = motions.Joint(static_cast<int>(joint));
  const double along_link = arriving.norm() > kLeastAcross ? arriving.normalized().dot(u) : 0.0;
  pivot.shift_u_sd =
      std::hypot(settings.tolerance.link * along_link, settings.tolerance.pivot_offset);
  const Vector3d link = settings.chain.Link(joint);
  pivot.growth = link.norm() > kLeastAcross ? motions.Shift(link.normalized()) : -1;
  return pivot;
}

struct BallMotions {
  int along, across, axial;
};

BallMotions AddBall(const SerialChain& chain, MotionChain& motions) {
  const Vector3d& axis = chain.axes().back().direction;
  const Vector3d link = chain.Link(chain.joints() - 1);
  const Vector3d along = link.norm() > kLeastAcross ? link.normalized() : AnyAcross(axis);
  const Vector3d across = Across(along, axis.cross(along));
  return {motions.Shift(along), motions.Shift(across), motions.Shift(along.cross(across))};
}

void AddGeometry(const LinkageSettings& settings, const std::vector<PivotMotions>& pivots,
                 const BallMotions& ball, ModelBuilder& model) {
  const LinkageTolerance& sd = settings.tolerance;
  model.Block("tilt", kMicroradians);
  for (std::size_t i = 0; i < pivots.size(); ++i) {
    const std::string name = PivotName(i);
    model.Entry(name + "_u", sd.pivot_angle, {.motion = pivots[i].tilt_u});
    model.Entry(name + "_v", sd.pivot_angle, {.motion = pivots[i].tilt_v});
  }
  model.Block("shift", kMicrometres);
  for (std::size_t i = 0; i < pivots.size(); ++i) {
    const std::string name = PivotName(i);
    model.Entry(name + "_u", pivots[i].shift_u_sd, {.motion = pivots[i].shift_u});
    model.Entry(name + "_v", sd.pivot_offset, {.motion = pivots[i].shift_v});
  }
  model.Block("ball", kMicrometres);
  model.Entry("along", sd.link, {.motion = ball.along});
  model.Entry("across", sd.ball, {.motion = ball.across});
  model.Entry("axial", sd.ball, {.motion = ball.axial});
}

void AddEncoders(const LinkageSettings& settings, const std::vector<PivotMotions>& pivots,
                 ModelBuilder& model) {
  const LinkageTolerance& sd = settings.tolerance;
  const auto count = static_cast<int>(pivots.size());
  model.Block("encoder_offset", kMicroradians);
  for (int i = 0; i < count; ++i) {
    model.Entry(PivotName(i), sd.encoder_offset, {.motion = pivots[i].turn});
  }
  model.Block("eccentricity", kMicroradians);
  for (int i = 0; i < count; ++i) {
    model.HarmonicEntries(PivotName(i), sd.eccentricity, pivots[i].turn, i, {1});
  }
  model.Block("graduation", kMicroradians);
  for (int i = 0; i < count; ++i) {
    model.HarmonicEntries(PivotName(i), sd.graduation, pivots[i].turn, i,
                          settings.graduation_harmonics);
  }
}

// An upright first joint feels no weight.
bool IsUpright(const LinkageSettings& settings, int joint) {
  const Vector3d& axis = settings.chain.axes()[joint].direction;
  return joint == 0 && axis.cross(settings.DownB()).norm() < kParallel;
}

// Each joint gives in proportion to the torque of all masses that it carries.
void AddTorques(const LinkageSettings& settings, const std::vector<PivotMotions>& pivots,
                ModelBuilder& model) {
  double weight = 0.0;  // N
  std::vector<int> hangs;
  for (const Mass& mass : settings.masses) {
    weight += kStandardGravity * mass.kg;
    hangs.push_back(model.motions.Weigh(static_cast<int>(mass.carrier), mass.point));
  }
  model.Block("weight", kMicroradiansPerNewtonMetre);
  for (int i = 0; i < std::ssize(pivots); ++i) {
    if (IsUpright(settings, i)) continue;
    bool first = true;
    for (std::size_t k = 0; k < hangs.size(); ++k) {
      const Mass& mass = settings.masses[k];
      if (mass.carrier < i) continue;
      const Effect effect{.motion = pivots[i].turn,
                          .basis = Basis::kWeight,
                          .joint = i,
                          .order = hangs[k],
                          .factor = kStandardGravity * mass.kg};
      if (first) {
        model.Entry(PivotName(i) + "_torque", settings.tolerance.weight / weight, effect);
      } else {
        model.Also(effect);
      }
      first = false;
    }
  }
}

// Each joint gives by itself under each weight that it carries, for neither the weights nor the
// compliances are known.
void AddWeights(const LinkageSettings& settings, const std::vector<PivotMotions>& pivots,
                ModelBuilder& model) {
  if (settings.tolerance.weight == 0.0) return;
  if (!settings.masses.empty()) {
    AddTorques(settings, pivots, model);
    return;
  }
  model.Block("weight", kMicroradiansPerMetre);
  for (int i = 0; i < std::ssize(pivots); ++i) {
    if (IsUpright(settings, i)) continue;
    for (const Weight& weight : WeightsBeyond(settings.chain, i)) {
      const int hangs = model.motions.Weigh(static_cast<int>(weight.carrier), weight.point);
      model.Entry(PivotName(i) + "_" + weight.name, settings.tolerance.weight,
                  {.motion = pivots[i].turn, .basis = Basis::kWeight, .joint = i, .order = hangs});
    }
  }
}

void AddPhysics(const LinkageSettings& settings, const std::vector<PivotMotions>& pivots,
                ModelBuilder& model) {
  const LinkageTolerance& sd = settings.tolerance;
  const auto count = static_cast<int>(pivots.size());
  model.Block("bearing", kMicrometres);
  for (int i = 0; i < count; ++i) {
    const std::string name = PivotName(i);
    model.HarmonicEntries(name + "_u", sd.bearing, pivots[i].shift_u, i,
                          settings.bearing_harmonics);
    model.HarmonicEntries(name + "_v", sd.bearing, pivots[i].shift_v, i,
                          settings.bearing_harmonics);
  }
  model.Block("compliance", kMicroradians);
  for (int i = 0; i < count; ++i) {
    if (!model.motions.FeelsGravity(i)) continue;
    model.Entry(PivotName(i), sd.compliance,
                {.motion = pivots[i].turn, .basis = Basis::kGravity, .joint = i});
  }
  AddWeights(settings, pivots, model);
  model.Block("expansion", kPartsPerMillionPerKelvin);
  for (int i = 0; i < count; ++i) {
    if (pivots[i].growth < 0) continue;
    model.Entry("after_" + PivotName(i), sd.thermal,
                {.motion = pivots[i].growth,
                 .basis = Basis::kWarmth,
                 .factor = settings.chain.Link(i).norm()},
                settings.expansion, 0.0);
  }
}

}  // namespace

LinkageModel CompleteErrorModel(const LinkageSettings& settings) {
  ModelBuilder model(settings);
  std::vector<PivotMotions> pivots;
  for (Index i = 0; i < settings.chain.joints(); ++i) {
    pivots.push_back(AddPivot(settings, i, model.motions));
  }
  const BallMotions ball = AddBall(settings.chain, model.motions);
  AddGeometry(settings, pivots, ball, model);
  AddEncoders(settings, pivots, model);
  AddPhysics(settings, pivots, model);
  return model.Build(ErrorModelName(ErrorModel::kComplete));
}

}  // namespace abbe::relm
