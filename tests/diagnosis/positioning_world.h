// Positioning tests after ISO 230-2 on the virtual rig: one axis goes to targets from both sides,
// in several cycles, under a grid encoder.
//
// The seed picks the machine, the noise and where the targets are; the diagnosis sees the machine
// alone (no head, no linkage) and the recording.
#pragma once

#include <string>
#include <vector>

#include "../folders.h"
#include "diagnosis/diagnose.h"
#include "machine/machine.h"
#include "random/counter_random.h"
#include "rig/campaign.h"
#include "rig/record_course.h"
#include "settings/document.h"

namespace abbe {

struct PositioningPlan {
  int axis = 0;
  int targets = 15, cycles = 5;
  double dwell = 1.0;  // s
};

class PositioningWorlds {
 public:
  PositioningWorlds()
      : document_(settings::Document::Read(DemoMillFile())),
        machine_(rig::ReadCampaignMachine(document_.Root())),
        linkage_(rig::ReadLinkage(document_.Root())) {}

  rig::Campaign Record(std::uint64_t seed, const std::vector<std::string>& hidden,
                       const PositioningPlan& plan = {}) const {
    rig::Campaign world;
    for (const std::string& text : hidden) {
      world.hidden.push_back(rig::ParseHidden(text, seed, machine_.sensors));
    }
    const rig::LinkageRig rig(rig::World(machine_.rig, seed, world.hidden),
                              rig::Linkage(linkage_, seed, world.hidden));
    world.recordings.push_back(
        rig.Record(CourseOf(seed, plan), {.kind = "reference", .rate = 10.0}));
    return world;
  }

  simulation::Instruments setup() const {
    return {machine::ReadMachine(document_.Root()), std::nullopt, {}, {}, std::nullopt};
  }

 private:
  // To each target from below, then back from above; beyond the ends by the overrun.
  static rig::Course CourseOf(std::uint64_t seed, const PositioningPlan& plan) {
    constexpr double kFirst = 2e-3, kLast = 58e-3, kOverrun = 1.5e-3, kFeed = 20e-3;
    const random::CounterRandom random(seed, 7);
    const double step = (kLast - kFirst) / plan.targets;
    std::vector<Eigen::Vector3d> targets;
    const auto place = [&](double along) {
      Eigen::Vector3d at = Eigen::Vector3d::Constant(30e-3);
      at[plan.axis] = along;
      return at;
    };
    for (int i = 0; i < plan.targets; ++i) {
      const double within = random.Uniform(static_cast<std::uint64_t>(i), 0.2, 0.8);
      targets.push_back(place(kFirst + step * (i + within)));
    }
    rig::Course course{place(kFirst - kOverrun), {}};
    for (int cycle = 1; cycle <= plan.cycles; ++cycle) {
      for (const auto& target : targets)
        course.moves.push_back({{target}, kFeed, plan.dwell, cycle, 1});
      course.moves.push_back({{place(kLast + kOverrun)}, kFeed});
      for (auto target = targets.rbegin(); target != targets.rend(); ++target)
        course.moves.push_back({{*target}, kFeed, plan.dwell, cycle, -1});
      course.moves.push_back({{place(kFirst - kOverrun)}, kFeed});
    }
    return course;
  }

  settings::Document document_;
  rig::CampaignMachine machine_;
  rig::LinkageSettings linkage_;
};

}  // namespace abbe
