// Effects that no cause of the catalogue makes, written for the virtual rig alone: some are in the
// grammar of learned terms, some are wider. A seed draws one with its size.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "random/counter_random.h"
#include "rig/hidden_effect.h"
#include "rig/run_parts.h"

namespace abbe {

// What is hidden, and what has to be said of it.
struct HiddenTerm {
  const rig::Effect* effect;
  std::string object;
  std::vector<int> places;  // the axis, probe or pivot that errs, and those that make it
  std::map<std::string, double> values;
  std::vector<std::string> stages;  // any of these is right
  std::set<std::string> variables;
  std::string form;   // how the expression begins; empty: the grammar lacks it
  double size = 0.0;  // of its coefficient, in um or urad
};

inline rig::HiddenEffects EffectsOf(const HiddenTerm& term, std::uint64_t seed) {
  return {rig::HiddenEffect{term.effect,
                            term.object,
                            term.places,
                            term.values,
                            {},
                            {},
                            random::CounterRandom(seed, 0x7E57)}};
}

namespace hidden_terms {

using rig::Effect;
using rig::HiddenEffect;
using rig::MachineState;
using rig::RunParts;

// An axis steps where another passes a place: a joint of two scales.
inline const Effect kStep{.name = "test-step",
                          .objects = rig::kAxisObject,
                          .in_run = [](const HiddenEffect& e, RunParts& run) {
                            run.Shift(e.place(), [height = e.At("height_um"), at = e.At("at_mm"),
                                                  by = e.places[1]](const MachineState& state) {
                              return state.position[by] >= at ? height : 0.0;
                            });
                          }};

// An axis goes with the product of its position and another's: height at 30 mm each.
inline const Effect kProduct{.name = "test-product",
                             .objects = rig::kAxisObject,
                             .in_run = [](const HiddenEffect& e, RunParts& run) {
                               run.Shift(
                                   e.place(), [by = e.At("height_um") / 9e-4, first = e.place(),
                                               second = e.places[1]](const MachineState& state) {
                                     return by * state.position[first] * state.position[second];
                                   });
                             }};

// A probe begins to drift at an instant: height after 1000 s.
inline const Effect kKink{.name = "test-kink",
                          .objects = rig::kProbeObject,
                          .in_run = [](const HiddenEffect& e, RunParts& run) {
                            run.Gap(e.place(), [rate = e.At("height_um") / 1000.0,
                                                from = e.At("from_s")](const MachineState& state) {
                              return rate * std::max(0.0, state.time - from);
                            });
                          }};

// A probe settles from the beginning of each run on.
inline const Effect kDecay{
    .name = "test-decay",
    .objects = rig::kProbeObject,
    .in_run = [](const HiddenEffect& e, RunParts& run) {
      run.Gap(e.place(), [height = e.At("height_um"), fades = e.At("fades_s"),
                          began = std::make_shared<double>(-1.0)](const MachineState& state) {
        if (*began < 0.0) *began = state.time;
        return height * std::exp(-(state.time - *began) / fades);
      });
    }};

// An axis falls behind with the square of the feed: height at 600 mm/min.
inline const Effect kSpeed{.name = "test-speed",
                           .objects = rig::kAxisObject,
                           .in_run = [](const HiddenEffect& e, RunParts& run) {
                             run.Shift(e.place(),
                                       [height = e.At("height_um")](const MachineState& state) {
                                         return height * state.velocity.squaredNorm() / 1e-4;
                                       });
                           }};

// An axis gives way to the motion of another: one sign, another sign.
inline const Effect kPushed{
    .name = "test-pushed",
    .objects = rig::kAxisObject,
    .in_run = [](const HiddenEffect& e, RunParts& run) {
      run.Shift(e.place(), [height = e.At("height_um"), by = e.places[1]](
                               const MachineState& state) { return height * state.direction[by]; });
    }};

// An encoder jumps at an angle.
inline const Effect kJump{
    .name = "test-jump",
    .objects = rig::kPivotObject,
    .keys = {{"height_urad", rig::Draw::kUniform, 0.0, 0.0}, {"at_rad", rig::Draw::kTurn}},
    .in_run = [](const HiddenEffect& e, RunParts& run) {
      if (std::isnan(e.At("at_rad"))) return;
      run.Angle(e.place(), [height = e.At("height_urad"), at = e.At("at_rad")](const MachineState&,
                                                                               double turn) {
        return std::remainder(turn - at, rig::kTurn) >= 0.0 ? height : 0.0;
      });
    }};

// Outside the grammar: a place where two axes together pass a line.
inline const Effect kCorner{
    .name = "test-corner",
    .objects = rig::kAxisObject,
    .in_run = [](const HiddenEffect& e, RunParts& run) {
      run.Shift(e.place(), [height = e.At("height_um"), at = e.At("at_mm"), first = e.places[1],
                            second = e.places[2]](const MachineState& state) {
        return state.position[first] + 2.0 * state.position[second] > 3.0 * at ? height : 0.0;
      });
    }};

// Outside: the product of all three positions, height at 30 mm each.
inline const Effect kThree{
    .name = "test-three",
    .objects = rig::kAxisObject,
    .in_run = [](const HiddenEffect& e, RunParts& run) {
      run.Shift(e.place(), [by = e.At("height_um") / 2.7e-5](const MachineState& state) {
        return by * state.position.prod();
      });
    }};

// Outside: what was driven is remembered and forgotten, height after a long way at 10 mm/s.
inline const Effect kMemory{
    .name = "test-memory",
    .objects = rig::kAxisObject,
    .in_run = [](const HiddenEffect& e, RunParts& run) {
      struct Warm {
        double time = 0.0, heat = 0.0;
      };
      run.Shift(e.place(), [height = e.At("height_um"), fades = e.At("fades_s"),
                            warm = std::make_shared<Warm>()](const MachineState& state) {
        const double way = state.velocity.norm() / 10e-3;
        const double step = std::max(0.0, state.time - warm->time);
        warm->heat = way + (warm->heat - way) * std::exp(-step / fades);
        warm->time = state.time;
        return height * warm->heat;
      });
    }};

inline std::string Axis(int axis) { return {static_cast<char>('X' + axis)}; }
inline std::string Position(int axis) { return {static_cast<char>('x' + axis)}; }

// A shift of an axis is the same in its positioning and in what other axes do along it.
inline std::vector<std::string> StagesOf(int axis) {
  std::vector<std::string> stages{Axis(axis)};
  for (int other = 0; other < 3; ++other) {
    if (other != axis) stages.push_back(fmt::format("E{}{}", Axis(axis), Axis(other)));
  }
  return stages;
}

}  // namespace hidden_terms

inline constexpr int kTermKinds = 10, kTermKindsInGrammar = 7;

// A term of one of kTermKinds kinds, as large as the effects that the rig hides.
inline HiddenTerm DrawTerm(std::uint64_t seed, int kind) {
  using namespace hidden_terms;
  const random::CounterRandom random(seed, 0x7E54);
  const auto pick = [&](std::uint64_t index, int count) {
    return static_cast<int>(random.Uniform(index, 0.0, 1.0) * count);
  };
  const auto size = [&](double low, double high) {
    return (random.Uniform(1, 0.0, 1.0) < 0.5 ? -1.0 : 1.0) * low *
           std::pow(high / low, random.Uniform(2, 0.0, 1.0));
  };
  const int axis = pick(3, 3), other = (axis + 1 + pick(4, 2)) % 3, third = 3 - axis - other;
  const double place = random.Uniform(5, 15.0, 45.0);
  const auto of_axis = [&](const Effect& effect, std::map<std::string, double> values,
                           std::set<std::string> variables, std::string form, double coefficient) {
    return HiddenTerm{&effect,        Axis(axis),           {axis, other, third}, std::move(values),
                      StagesOf(axis), std::move(variables), std::move(form),      coefficient};
  };
  const std::string v = Position(other);
  switch (kind) {
    case 0: {
      const double height = size(1.0, 6.0);
      return of_axis(kStep, {{"height_um", height}, {"at_mm", place}}, {v},
                     fmt::format("step({}", v), height);
    }
    case 1: {
      const double height = size(1.0, 8.0);
      const std::string first = Position(std::min(axis, other)),
                        last = Position(std::max(axis, other));
      return of_axis(kProduct, {{"height_um", height}}, {first, last},
                     fmt::format("{} * {}", first, last), height / 900.0);
    }
    case 2: {
      const int probe = pick(6, 5);
      const double height = size(0.5, 4.0);
      const std::string name = fmt::format("probe_{}", "abcde"[probe]);
      return {
          &kKink,           name,
          {probe},          {{"height_um", height}, {"from_s", random.Uniform(7, 100.0, 400.0)}},
          {name},           {"time"},
          "max(0, time - ", height / 1000.0};
    }
    case 3: {
      const int probe = pick(6, 5);
      const double height = size(0.3, 3.0);
      const std::string name = fmt::format("probe_{}", "abcde"[probe]);
      return {&kDecay,
              name,
              {probe},
              {{"height_um", height}, {"fades_s", random.Uniform(8, 10.0, 60.0)}},
              {name},
              {"time of run"},
              "exp(-time of run / ",
              height};
    }
    case 4: {
      const double height = size(2.0, 15.0);
      return of_axis(kSpeed, {{"height_um", height}}, {"feed"}, "feed^2", height / 36e4);
    }
    case 5: {
      const double height = size(0.5, 5.0);
      return of_axis(kPushed, {{"height_um", height}}, {v}, fmt::format("sign({}", v), height);
    }
    case 6: {
      const int pivot = pick(6, 3);
      const std::string name = fmt::format("pivot_{}", pivot + 1);
      const double height = size(15.0, 120.0);
      return {&kJump,
              name,
              {pivot},
              {{"height_urad", height}, {"at_rad", std::nan("")}},
              {name},
              {name},
              fmt::format("step({}", name),
              height};
    }
    case 7:
      return of_axis(kCorner, {{"height_um", size(2.0, 10.0)}, {"at_mm", place}},
                     {v, Position(third)}, "", 0.0);
    case 8:
      return of_axis(kThree, {{"height_um", size(2.0, 10.0)}}, {"x", "y", "z"}, "", 0.0);
    default:
      return of_axis(kMemory,
                     {{"height_um", size(2.0, 10.0)}, {"fades_s", random.Uniform(8, 20.0, 200.0)}},
                     {"time", "feed"}, "", 0.0);
  }
}

}  // namespace abbe
