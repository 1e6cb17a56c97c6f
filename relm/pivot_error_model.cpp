// The errors of the RELM paper, figure 4.
#include "failure/failure.h"
#include "relm/error_models.h"
#include "relm/model_builder.h"

namespace abbe::relm {

LinkageModel PivotErrorModel(const LinkageSettings& settings) {
  using Eigen::Vector3d;
  if (!settings.pivots) {
    throw InputError(
        "linkage: the error model of two links and three pivots needs form = \"pivots\"; use the "
        "complete model");
  }
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  const Vector3d base = Vector3d::Zero(), elbow = settings.pivots->link_1() * x;

  ModelBuilder model(settings);
  MotionChain& motions = model.motions;
  const int tilt_x = motions.Turn(base, x);
  const int tilt_y = motions.Turn(base, y);
  const int pivot_1 = motions.Joint(0);
  const int twist_2 = motions.Turn(base, x);
  const int divergence_x = motions.Shift(x);
  const int divergence_y = motions.Shift(y);
  const int pivot_2 = motions.Joint(1);
  const int link_1 = motions.Shift(x);
  const int twist_link = motions.Turn(elbow, x);
  const int pivot_3 = motions.Joint(2);
  const int link_2 = motions.Shift(z);

  const LinkageTolerance& sd = settings.tolerance;
  const double length_1 = settings.pivots->link_1(), length_2 = settings.pivots->link_2();
  model.Block("link", kMillimetres);
  model.Entry("link_1", sd.link, {.motion = link_1}, length_1, length_1);
  model.Entry("link_2", sd.link, {.motion = link_2}, length_2, length_2);
  model.Block("tilt", kMicroradians);
  model.Entry("pivot_1_x", sd.pivot_angle, {.motion = tilt_x});
  model.Entry("pivot_1_y", sd.pivot_angle, {.motion = tilt_y});
  model.Block("twist", kMicroradians);
  model.Entry("pivot_2", sd.pivot_angle, {.motion = twist_2});
  model.Entry("link_1", sd.pivot_angle, {.motion = twist_link});
  model.Block("divergence", kMicrometres);
  model.Entry("pivot_2_x", sd.pivot_offset, {.motion = divergence_x});
  model.Entry("pivot_2_y", sd.pivot_offset, {.motion = divergence_y});
  model.Block("encoder_offset", kMicroradians);
  model.Entry("pivot_1", sd.encoder_offset, {.motion = pivot_1});
  model.Entry("pivot_2", sd.encoder_offset, {.motion = pivot_2});
  model.Entry("pivot_3", sd.encoder_offset, {.motion = pivot_3});
  return model.Build(ErrorModelName(ErrorModel::kPivots));
}

}  // namespace abbe::relm
