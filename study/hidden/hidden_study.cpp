#include "study/hidden/hidden_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "diagnosis/hold_out.h"
#include "failure/failure.h"
#include "study/hidden/judgement.h"
#include "study/hidden/rate_table.h"
#include "study/hidden/visible_effects.h"

namespace abbe::study {
namespace {

using Sum = decltype(StudyKind::sum);

constexpr auto kCampaign = rig::CampaignKind::kStandard;

const LinesAndTruth kSmoother{{"smoothness_mm = 15.0", "smoothness_mm = 40.0"},
                              {"straightness_um = 1.0", "straightness_um = 0.4"},
                              {"positioning_um = 2.0", "positioning_um = 0.8"},
                              {"pitch_urad = 20.0", "pitch_urad = 7.0"}};

bool IsCertain(const Finding& finding) {
  return diagnosis::IsModelled(finding) && finding.probability >= diagnosis::kCertain;
}

// What everybody would want to know of a world.
Row Described(const rig::Campaign& world, const Diagnosis& diagnosis) {
  Row row{{"hidden", rig::TruthOf(world.hidden)},
          {"verdict", diagnosis::Name(diagnosis.verdict)},
          {"chi_before", diagnosis.chi_before},
          {"chi_after", diagnosis.chi_after},
          {"findings", Row::array()},
          {"left", Row::array()}};
  for (const Finding& finding : diagnosis.findings) {
    Row found{{"name", finding.score.candidate.Name()}, {"probability", finding.probability}};
    const auto keys = KeysOf(finding.score);
    for (Eigen::Index i = 0; i < keys.values.size(); ++i) {
      const auto& key = finding.score.candidate.cause->keys[i];
      found[key.name] = keys.values[i] / key.unit;
      found["u_" + key.name] = keys.u[i] / key.unit;
    }
    row["findings"].push_back(std::move(found));
  }
  for (const auto& left : diagnosis.leftovers) {
    row["left"].push_back(fmt::format("{} over {}", left.object, left.variable));
  }
  return row;
}

// The same effect with the largest sizes that the rig hides.
std::string Largest(const rig::HiddenEffect& effect) {
  std::string text = fmt::format("{}:object={}", effect.entry->name, effect.object);
  for (const rig::KeyEntry& key : effect.entry->keys) {
    if (key.draw == rig::Draw::kEven || key.draw == rig::Draw::kEvenSigned) {
      text += fmt::format(":{}={}", key.name, key.high);
    }
  }
  return text;
}

bool IsOfData(const rig::HiddenEffect& effect) {
  return effect.entry->name == "stuck-channel" || effect.entry->name == "outliers";
}

// Whether what the only cause leaves of the rows that were held out is within 5 % of the noise.
std::optional<bool> IsAtFloor(const HiddenWorlds& worlds, const rig::Campaign& world,
                              const Diagnosis& diagnosis) {
  constexpr double kOfTheFloor = 1.05;
  const Finding& finding = diagnosis.findings.front();
  // What each run has of its own nobody predicts in another.
  if (!diagnosis::IsModelled(finding) || finding.score.candidate.cause->own_in_each_run) {
    return std::nullopt;
  }
  const auto gain = diagnosis::HoldOut(CampaignOf(diagnosis, worlds.Recordings(world)),
                                       world.recordings, {finding.score.candidate});
  if (gain.rows == 0) return std::nullopt;
  return gain.after <= kOfTheFloor;
}

class HiddenStudy : public Study {
 public:
  explicit HiddenStudy(HiddenWorlds worlds) : worlds_(std::move(worlds)) {}

 protected:
  const HiddenWorlds& worlds() const { return worlds_; }
  // Half a minute of work, the first time.
  const VisibleEffects& visible() const {
    std::call_once(once_, [&] { visible_.emplace(worlds_); });
    return *visible_;
  }
  Diagnosis DiagnosisOf(const rig::Campaign& world) const {
    return diagnosis::Diagnose(worlds_.Recordings(world));
  }

 private:
  HiddenWorlds worlds_;
  mutable std::once_flag once_;
  mutable std::optional<VisibleEffects> visible_;
};

class Clean : public HiddenStudy {
 public:
  using HiddenStudy::HiddenStudy;
  Row World(std::uint64_t seed) const override {
    const rig::Campaign world = worlds().Record(seed, {});
    return Described(world, DiagnosisOf(world));
  }
  static Summary SumOf(const std::string& variant, const std::vector<Row>& rows) {
    Rate alarms;
    for (const Row& row : rows) alarms.Add(row.at("verdict") != "clean");
    const double most = variant == "clean-white" ? 0.01 : 0.02;
    return {{}, {{"something is said where nothing is hidden", alarms, 0.0, most}}};
  }
};

// Any cause, any object, any size, seen in these runs or not.
class OneEffect : public HiddenStudy {
 public:
  using HiddenStudy::HiddenStudy;
  Row World(std::uint64_t seed) const override {
    const random::CounterRandom random(seed, 0x41DE);
    const std::string hidden = DrawHidden(random, 0, true);
    const rig::Campaign world = worlds().Record(seed, {hidden});
    const rig::HiddenEffect& truth = world.hidden.front();
    const Diagnosis diagnosis = DiagnosisOf(world);
    Row row = Described(world, diagnosis);
    if (IsOfData(truth)) {  // no columns: seen row by row or not at all
      row.update(JudgeOne(truth, {.largest = kSeen}, diagnosis));
      return row;
    }
    const auto column = visible().ColumnOf({hidden}, seed);
    row.update(JudgeOne(truth,
                        {.alone = column.norm(),
                         .beside = visible().BesideRivals(column, NameOf(truth)),
                         .largest = visible().ColumnOf({Largest(truth)}, seed).norm()},
                        diagnosis));
    if (diagnosis.findings.size() == 1 && Names(diagnosis.findings.front(), truth)) {
      if (const auto at_floor = IsAtFloor(worlds(), world, diagnosis)) row["at_floor"] = *at_floor;
    }
    return row;
  }
};

class TwoEffects : public HiddenStudy {
 public:
  using HiddenStudy::HiddenStudy;
  Row World(std::uint64_t seed) const override {
    const random::CounterRandom random(seed, 0x2A1D);
    const std::vector<std::string> hidden{DrawHidden(random, 0, true), DrawHidden(random, 8, true)};
    const rig::Campaign world = worlds().Record(seed, hidden);
    if (!AreSeparable(world, hidden, seed)) {
      return {{"hidden", rig::TruthOf(world.hidden)}, {"is_separable", false}};
    }
    const Diagnosis diagnosis = DiagnosisOf(world);
    Row row = Described(world, diagnosis);
    row["is_separable"] = true;
    row["are_found"] = std::ranges::all_of(world.hidden, [&](const rig::HiddenEffect& effect) {
      return std::ranges::any_of(diagnosis.findings,
                                 [&](const Finding& one) { return Names(one, effect); });
    });
    return row;
  }
  static Summary SumOf(const std::string& /*variant*/, const std::vector<Row>& rows) {
    Rate found;
    for (const Row& row : rows) {
      if (row.at("is_separable").get<bool>()) found.Add(row.at("are_found").get<bool>());
    }
    return {{}, {{"separable and both found", found, 0.90, 1.0}}};
  }

 private:
  bool AreSeparable(const rig::Campaign& world, const std::vector<std::string>& hidden,
                    std::uint64_t seed) const {
    if (world.hidden[0].entry == world.hidden[1].entry) return false;
    for (std::size_t i = 0; i < hidden.size(); ++i) {
      if (IsOfData(world.hidden[i])) return false;
      const auto column = visible().ColumnOf({hidden[i]}, seed);
      if (visible().BesideRivals(column, NameOf(world.hidden[i])) <= kSeen) return false;
    }
    return true;
  }
};

// An effect that no cause of the catalogue is.
class UnknownEffect : public HiddenStudy {
 public:
  using HiddenStudy::HiddenStudy;
  Row World(std::uint64_t seed) const override {
    const random::CounterRandom random(seed, 0x0BAD);
    const std::string hidden = DrawHidden(random, 0, false);
    const rig::Campaign world = worlds().Record(seed, {hidden});
    const Diagnosis diagnosis = DiagnosisOf(world);
    Row row = Described(world, diagnosis);
    row["beside"] = visible().BesideRivals(visible().ColumnOf({hidden}, seed), "");
    row["is_placed"] = diagnosis.verdict == Verdict::kUnexplained &&
                       LivesIn(diagnosis, rig::TruthOf(world.hidden)[0].at("variable"));
    row["is_certain_of_a_cause"] = std::ranges::any_of(diagnosis.findings, IsCertain);
    return row;
  }
  static Summary SumOf(const std::string& /*variant*/, const std::vector<Row>& rows) {
    Rate placed, explained, certain;
    for (const Row& row : rows) {
      explained.Add(row.at("verdict") == "explained");
      certain.Add(row.at("is_certain_of_a_cause").get<bool>());
      if (row.at("beside").get<double>() > kSeen) placed.Add(row.at("is_placed").get<bool>());
    }
    return {{},
            {{"`unexplained`, with the right variable", placed, 0.90, 1.0},
             {"`explained`, by something else", explained, 0.0, 0.02},
             {"a cause that is not there at 0.99 or more", certain, 0.0, 0.01}}};
  }
};

struct Variant {
  std::string_view name;
  std::unique_ptr<const Study> (*make)(const std::filesystem::path& machine);
  Sum sum;
};

using Worlds = const std::filesystem::path&;
template <class Of>
std::unique_ptr<const Study> OnStated(Worlds machine) {
  return std::make_unique<Of>(HiddenWorlds(machine, kCampaign));
}
template <class Of>
std::unique_ptr<const Study> OnRougher(Worlds machine) {
  return std::make_unique<Of>(HiddenWorlds(machine, kCampaign).Unlike(kRougher));
}
std::unique_ptr<const Study> OnSmoother(Worlds machine) {
  return std::make_unique<Clean>(HiddenWorlds(machine, kCampaign).Unlike(kSmoother));
}
std::unique_ptr<const Study> OnWhite(Worlds machine) {
  return std::make_unique<Clean>(HiddenWorlds(machine, kCampaign, HiddenWorlds::Noise::kWhite));
}

constexpr std::array<Variant, 8> kVariants{{
    {"one-effect", OnStated<OneEffect>, SumOfOne},
    {"one-effect-rougher", OnRougher<OneEffect>, SumOfOne},
    {"two-effects", OnStated<TwoEffects>, TwoEffects::SumOf},
    {"unknown", OnStated<UnknownEffect>, UnknownEffect::SumOf},
    {"clean", OnStated<Clean>, Clean::SumOf},
    {"clean-white", OnWhite, Clean::SumOf},
    {"clean-rougher", OnRougher<Clean>, Clean::SumOf},
    {"clean-smoother", OnSmoother, Clean::SumOf},
}};

const Variant& VariantOf(const std::string& name) {
  const auto at = std::ranges::find(kVariants, name, &Variant::name);
  if (at == kVariants.end()) {
    throw InputError(fmt::format("study hidden: there is no variant \"{}\"", name));
  }
  return *at;
}

std::vector<std::string_view> VariantNames() {
  std::vector<std::string_view> names;
  for (const Variant& variant : kVariants) names.push_back(variant.name);
  return names;
}

}  // namespace

const StudyKind kHiddenStudy{
    .name = "hidden",
    .what = "How often the diagnosis is right about what the virtual rig hides",
    .variants = VariantNames(),
    .make =
        [](const Question& question) { return VariantOf(question.variant).make(question.machine); },
    .sum = [](const std::string& variant,
              const std::vector<Row>& rows) { return VariantOf(variant).sum(variant, rows); }};

}  // namespace abbe::study
