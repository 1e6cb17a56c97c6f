// Builds an error model: first the motions from base to ball, then the parameters block by block,
// each with its effect. Used by the error models only.
//
//   ModelBuilder model(settings);
//   const int tilt = model.motions.Turn(point, direction);
//   model.Block("tilt", kMicroradians);
//   model.Entry("pivot_1_x", settings.tolerance.pivot_angle, {.motion = tilt});
//   const LinkageModel built = model.Build("pivots");
//
// A parameter with a tolerance of zero is known: it is held.
#pragma once

#include <string>
#include <vector>

#include "relm/linkage_model.h"
#include "relm/linkage_settings.h"
#include "settings/unit.h"

namespace abbe::relm {

class ModelBuilder {
 public:
  explicit ModelBuilder(const LinkageSettings& settings);

  // Begins a block; a block without entries is left out.
  void Block(const std::string& name, const estimation::PrintUnit& unit);
  // A deviation from zero with the prior `sd`; `effect.parameter` is filled in.
  void Entry(const std::string& name, double sd, Effect effect);
  // A parameter with a nominal value, whose effects vanish at `rest`.
  void Entry(const std::string& name, double sd, Effect effect, double nominal, double rest);
  // The last parameter acts by another effect too.
  void Also(Effect effect);
  // Sine and cosine amplitudes of harmonics of a joint's angle, "<prefix>_sin_<order>".
  void HarmonicEntries(const std::string& prefix, double sd, int motion, int joint,
                       const std::vector<int>& orders);

  LinkageModel Build(const std::string& name) const;

  MotionChain motions;

 private:
  std::vector<estimation::ParameterBlock> blocks_;
};

using estimation::kMicroradians;
inline const estimation::PrintUnit kMicroradiansPerMetre{"urad/m", settings::kMicroradian};
inline const estimation::PrintUnit kMicroradiansPerNewtonMetre{"urad/(N m)",
                                                               settings::kMicroradian};
using estimation::kMicrometres;
inline const estimation::PrintUnit kMillimetres{"mm", settings::kMillimetre};
inline const estimation::PrintUnit kPartsPerMillionPerKelvin{"ppm/degC", 1e-6};

std::string PivotName(Eigen::Index joint);  // "pivot_1" for joint 0

}  // namespace abbe::relm
