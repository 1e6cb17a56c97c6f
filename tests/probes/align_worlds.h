// Set-ups of the virtual rig to be aligned: the target badly mounted, its screws turned by hand.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "../folders.h"
#include "failure/failure.h"
#include "machine/machine.h"
#include "probes/head_alignment.h"
#include "probes/head_settings.h"
#include "random/counter_random.h"
#include "rig/rig_settings.h"
#include "rig/target_screws.h"
#include "rig/world.h"
#include "settings/document.h"

namespace abbe::probes {

inline settings::Document DemoMill() { return settings::Document::Read(DemoMillFile()); }

// The target tilted by up to 2 mrad about each axis, the gaps set to the middle within 25 um.
inline rig::RigSettings BadlyMounted() {
  rig::RigSettings settings = rig::ReadRigSettings(DemoMill().Root());
  settings.target_tilt = 2e-3;
  settings.gap_setting = 25e-6;
  return settings;
}

// The table of the demonstration machine, without [align] on request.
struct HeadSetup {
  explicit HeadSetup(char which = 'X', AlignSettings with = ReadAlignSettings(DemoMill().Root()))
      : machine(machine::ReadMachine(DemoMill().Root())),
        head(ReadHeadSettings(DemoMill().Root())),
        settings(std::move(with)),
        axis(which),
        aligner(machine, head, settings, which, 0.0, kTravel) {}

  static constexpr double kTravel = 60e-3;
  machine::Machine machine;
  HeadSettings head;
  AlignSettings settings;
  char axis;
  HeadAligner aligner;
};

// The operator before the rig.
class Operator {
 public:
  using Wires = std::function<PerProbe<>(PerProbe<>)>;  // what the channels show of the gaps

  Operator(
      const HeadSetup& setup, const rig::RigSettings& settings, std::uint64_t seed,
      Wires wires = [](PerProbe<> gaps) { return gaps; })
      : setup_(setup),
        world_(settings, seed),
        screws_(settings, world_.CornerOf(Number())),
        random_(seed, 0xa119),
        wires_(std::move(wires)) {}

  PerProbe<> GapsAtPosition(double position) const {
    Eigen::Vector3d command = world_.settings().StartOf(Number());
    command[Number()] = position;
    return world_.ReadingsAt(Number(), command, screws_.Seat());
  }
  bool InRange(double position) const {
    const PerProbe<> gaps = GapsAtPosition(position);
    for (std::size_t i = 0; i < kProbes; ++i) {
      if (gaps[i] < 0.0 || gaps[i] > setup_.aligner.ranges()[i]) return false;
    }
    return true;
  }
  // The positions, mm by mm, where all gaps are shown.
  std::vector<double> Readable() const {
    std::vector<double> good;
    for (double position = 0.0; position <= HeadSetup::kTravel + 1e-9; position += 1e-3) {
      if (InRange(position)) good.push_back(position);
    }
    return good;
  }
  bool CanRead() const {
    const std::vector<double> good = Readable();
    return !good.empty() && good.back() - good.front() > 4e-3;
  }
  // Reads at the ends of that stretch.
  void Read() {
    const std::vector<double> good = Readable();
    if (good.empty()) throw InputError("no gap is shown anywhere");
    for (const double position : {good.front(), good.back()}) {
      readings.push_back({static_cast<int>(turned.size()), setup_.aligner.TravelOf(position),
                          wires_(GapsAtPosition(position))});
    }
  }
  // Turns as prescribed, within 5 % and 5 degrees.
  void Turn(const std::vector<ScrewTurn>& turns) {
    for (const ScrewTurn& turn : turns) {
      const double done = turn.turns * (1.0 + 0.05 * random_.Normal(draws_)) +
                          5.0 / 360.0 * random_.Normal(draws_ + 1);
      draws_ += 2;
      screws_.Turn(setup_.settings.screws[turn.screw].name, done);
    }
    turned.push_back(turns);
  }

  std::vector<GapsAt> readings;
  std::vector<std::vector<ScrewTurn>> turned;

 private:
  int Number() const { return setup_.axis - 'X'; }

  const HeadSetup& setup_;
  rig::World world_;
  rig::TargetScrews screws_;
  random::CounterRandom random_;
  std::uint64_t draws_ = 0;
  Wires wires_;
};

}  // namespace abbe::probes
