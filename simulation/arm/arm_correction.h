// A recording of an arm corrected for causes (correction.h).
//
// What a joint shows wrongly is subtracted from its angle; what turns a joint, moves a link or the
// whole arm beside its angles is subtracted from where the instrument saw the ball, as the nominal
// arm has it where it stands by the recording itself. Failure: that of ReadLinkageRun and Placed.
#pragma once

#include <vector>

#include "recording/recording.h"
#include "relm/linkage_settings.h"
#include "simulation/correction.h"

namespace abbe::simulation {

Correction CorrectArm(const recording::Recording& recording,
                      const std::vector<ModelledCause>& causes, const Origin& origin,
                      const relm::LinkageSettings& settings);

}  // namespace abbe::simulation
