// One machine with its instruments, drawn from what the machine file says of such machines: the
// unknowns of a campaign before anything was measured.
//
//   const Values machine = DrawnMachine(campaign, normal);
//
// Error functions come from their process (fusion/machine_prior.h), everything else from its prior.
// What a fitter sets is not drawn: the target is aligned to kAligned, the gaps stand in the middle
// of the range. Units: SI.
#pragma once

#include <functional>
#include <vector>

#include "diagnosis/campaign.h"
#include "diagnosis/linear_runs.h"

namespace abbe::diagnosis {

inline constexpr double kAligned = 100e-6;  // rad, of a target that was set by an indicator

// `normal`: the next of independent standard normal numbers.
Values DrawnMachine(const Campaign& campaign, const std::function<double()>& normal);
// The same for runs that are not in the campaign.
Values DrawnMachine(const Campaign& campaign, const std::vector<PreparedRun>& runs,
                    const std::function<double()>& normal);

}  // namespace abbe::diagnosis
