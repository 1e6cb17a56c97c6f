#include "relm/nominal_angles.h"

#include "relm/chain_inverse.h"

namespace abbe::relm {

Eigen::VectorXd NominalAngles(const LinkageSettings& settings, const Eigen::Vector3d& p_BT,
                              const std::optional<Eigen::VectorXd>& near) {
  if (settings.pivots) {
    const Eigen::VectorXd angles = settings.pivots->Angles(p_BT, settings.branch);
    return near ? Unwrapped(angles, *near) : angles;
  }
  constexpr double kBent = 0.5;  // rad: no joint in line with the next
  return ChainInverse(settings.chain)
      .Angles(p_BT, near.value_or(Eigen::VectorXd::Constant(settings.chain.joints(), kBent)));
}

}  // namespace abbe::relm
