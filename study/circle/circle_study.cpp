#include "study/circle/circle_study.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "fusion/circle_causes.h"
#include "fusion/smooth_harmonics.h"
#include "machine/machine.h"
#include "paths/circle_run.h"
#include "paths/measured_path.h"
#include "random/counter_random.h"
#include "rig/hidden_effect.h"
#include "rig/record_course.h"
#include "settings/document.h"

namespace abbe::study {
namespace {

constexpr double kCoverage = 2.0;

struct Drawn {
  double radius, feed;  // m, m/s
  char axis;
  double width;  // um, of the backlash
};

Drawn Draw(std::uint64_t seed) {
  const random::CounterRandom random(seed, 0xC12C);
  return {.radius = random.Uniform(0, 10e-3, 25e-3),
          .feed = 5e-3 * std::pow(10.0, random.Uniform(1)),
          .axis = random.Uniform(2) < 0.5 ? 'X' : 'Y',
          .width = std::pow(10.0, random.Uniform(3, std::log10(0.5), std::log10(15.0)))};
}

// What no sound axis has.
bool IsFault(const fusion::CauseEstimate& one) {
  return one.cause == "backlash" || one.cause == "reversal_spike" || one.cause == "servo_mismatch";
}

class CircleStudy : public Study {
 public:
  explicit CircleStudy(const Question& question)
      : document_(settings::Document::Read(question.machine)),
        machine_(machine::ReadMachine(document_.Root())),
        rig_(rig::ReadRigSettings(document_.Root())),
        linkage_(rig::ReadLinkage(document_.Root())),
        hides_(question.variant == "backlash") {}

  Row World(std::uint64_t seed) const override {
    const Drawn drawn = Draw(seed);
    const fusion::CircleCauses found = CausesOf(seed, drawn);
    Row row{{"radius_mm", 1e3 * drawn.radius}, {"feed_mm_min", 6e4 * drawn.feed}};
    if (hides_) row["axis"] = std::string(1, drawn.axis), row["width_um"] = drawn.width;
    Rate others;
    for (const fusion::CauseEstimate& one : found.causes) {
      if (!IsFault(one)) continue;
      const bool is_hidden = hides_ && one.cause == "backlash" && one.object[0] == drawn.axis;
      if (is_hidden) {
        row["found_um"] = 1e6 * one.value;
        row["u_um"] = 1e6 * one.u;
      } else {
        others.Add(std::abs(one.value) > kCoverage * one.u);
      }
    }
    row["others"] = others.worlds;
    row["others_beyond"] = others.met;
    return row;
  }

  static Summary SumOf(const std::string& /*variant*/, const std::vector<Row>& rows) {
    Rate inside, others;
    double squares = 0.0;
    for (const Row& row : rows) {
      others.Add(RateOf(row, "others", "others_beyond"));
      if (!row.contains("found_um")) continue;
      const double pull = (row.at("found_um").get<double>() - row.at("width_um").get<double>()) /
                          row.at("u_um").get<double>();
      inside.Add(std::abs(pull) <= kCoverage);
      squares += pull * pull;
    }
    Summary summary;
    if (inside.worlds > 0) {
      summary.text =
          fmt::format("Errors over u, rms: {:.2f}\n", std::sqrt(squares / inside.worlds));
      summary.bounds.push_back({"backlash inside U95", inside, 0.92, 0.99});
    }
    summary.bounds.push_back({"faults that are not there beyond U95", others, 0.0, 0.06});
    return summary;
  }

 private:
  fusion::CircleCauses CausesOf(std::uint64_t seed, const Drawn& drawn) const {
    rig::HiddenEffects hidden;
    if (hides_) {
      const std::string text =
          fmt::format("backlash:object={}:width_um={:.17g}", drawn.axis, drawn.width);
      hidden.push_back(rig::ParseHidden(text, seed, {}));
    }
    const rig::LinkageRig rig(rig::World(rig_, seed, std::move(hidden)),
                              rig::Linkage(linkage_, seed));
    rig::CircleProgram program;
    for (int i = 0; i < 3; ++i) {
      program.centre[i] = 0.5 * (machine_.travels[i].first + machine_.travels[i].last);
    }
    program.radius = drawn.radius;
    program.feed = drawn.feed;
    const auto path =
        paths::ReferencePath(rig.Record(CircleCourse(program), {.kind = "reference"}));
    const std::vector<paths::CircleRun> runs = paths::CircleRuns({path});
    std::vector<const paths::CircleRun*> all;
    all.reserve(runs.size());
    for (const paths::CircleRun& run : runs) all.push_back(&run);
    fusion::CauseOptions options;
    options.smooth = fusion::SmoothHarmonics(machine_, runs.front());
    return fusion::FitCircleCauses(all, options);
  }

  settings::Document document_;
  machine::Machine machine_;
  rig::RigSettings rig_;
  rig::LinkageSettings linkage_;
  bool hides_;
};

}  // namespace

const StudyKind kCircleStudy{
    .name = "circle",
    .what = "Whether the causes of a circle find backlash, and nothing that is not there",
    .variants = {"backlash", "none"},
    .make = [](const Question& question) -> std::unique_ptr<const Study> {
      return std::make_unique<CircleStudy>(question);
    },
    .sum = CircleStudy::SumOf};

}  // namespace abbe::study
