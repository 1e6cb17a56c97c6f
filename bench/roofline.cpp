// How far five kernels stand from what the processor can do at all: the processor time of one item
// beside the time that its floating-point operations, its divisions and roots, and its way through
// the memory take at least on one core. The limits are measured in the same run.
//
//   bench/roofline [SECONDS]            // of each kernel in each place, 0.5 by default
//
// One flop is an addition, subtraction or multiplication; a division or a square root is counted
// apart, since it occupies the divider for many cycles. Bytes are those of the state that is read
// and written once; what is written is counted twice, since its line is read before (the copy that
// measures the memory counts so too). "memory": items fill several times the last cache; "cache":
// few items again and again, whose limit is arithmetic alone.
//
// Flops of one item, as the sources have them (no more than is needed; no index arithmetic):
//   head inversion     probes/head_inversion.h, MovingTarget: planes 8, quadratic 23, angles 13,
//                      straightnesses 27, check 3; 3 + 1 divisions (the last in the quadratic), 1
//                      root. 5 readings and d in, 6 errors out.
//   linkage forward    relm/pivot_linkage_batch.cpp: three sines and cosines of 37, 11 for the tip. 3
//                      angles in, 3 coordinates out.
//   map, exact         machine/volumetric_kernels.cpp: for each axis a cubic of 6 numbers 36, its
//                      place 4, a turn (series 12, square 5, products 30) and a way 11; error 9.
//   map with 81 slopes for each axis besides the slopes of the cubic 42 and Walk 316 (square and
//                      series 23, two turn matrices 60, six vectors turned 90, products of matrices
//                      and vectors 60, the rest 83); chain 80; 84 numbers out.
//   projection         diagnosis/projection.cpp: a column of a candidate against J and r of all runs
//                      in which it acts, 2 rows (parameters + 1), and against all other parameters,
//                      n^2 of the triangular solve. Whitening and the making of columns are extra.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "roofline.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace abbe::bench::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

// Twelve chains that do not wait for each other; operations of each lane.
template <typename Step>
double InChains(std::size_t rounds, const Step& step) {
  const auto set = [](double value) { return hn::Set(D(), value); };  // else they would be one
  V a = set(1.1), b = set(1.2), c = set(1.3), d = set(1.4), e = set(1.5), f = set(1.6),
    g = set(1.7), h = set(1.8), i = set(1.9), j = set(2.1), k = set(2.2), l = set(2.3);
  for (std::size_t round = 0; round < rounds; ++round) {
    a = step(a), b = step(b), c = step(c), d = step(d), e = step(e), f = step(f);
    g = step(g), h = step(h), i = step(i), j = step(j), k = step(k), l = step(l);
  }
  return hn::GetLane(a + b + c + d + e + f + g + h + i + j + k + l);
}

double Fused(std::size_t rounds) {
  const V x = hn::Set(D(), 0.999), y = hn::Set(D(), 1e-3);
  return InChains(rounds, [=](V v) { return hn::MulAdd(v, x, y); });
}
double Divided(std::size_t rounds) {
  const V x = hn::Set(D(), 1.21);
  return InChains(rounds, [=](V v) { return x / v; });
}
double Rooted(std::size_t rounds) {
  return InChains(rounds, [](V v) { return hn::Sqrt(v); });
}
std::size_t Lanes() { return hn::Lanes(D()); }

double Copied(const double* from, std::size_t count, double* to) {
  const D d;
  const std::size_t lanes = hn::Lanes(d);
  for (std::size_t i = 0; i + lanes <= count; i += lanes) {
    hn::StoreU(hn::LoadU(d, from + i), d, to + i);
  }
  return to[count / 2];
}

}  // namespace abbe::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <oneapi/tbb/global_control.h>

#include "clock.h"
#include "column_machine.h"
#include "diagnosis/evidence.h"
#include "diagnosis/fit.h"
#include "estimation/linearization.h"
#include "fusion/machine_problem.h"
#include "machine/volumetric_field.h"
#include "probes/head_inversion.h"
#include "probes/head_settings.h"
#include "random/counter_random.h"
#include "relm/linkage_settings.h"
#include "relm/pivot_linkage.h"
#include "rig/campaign.h"
#include "settings/document.h"
#include "width.h"

namespace abbe::bench {
namespace {

HWY_EXPORT(Fused);
HWY_EXPORT(Divided);
HWY_EXPORT(Rooted);
HWY_EXPORT(Lanes);
HWY_EXPORT(Copied);

using Eigen::Index;
using Work = std::function<void()>;

// Seconds of the fastest run.
double Fastest(const Work& work, double seconds) {
  double best = std::numeric_limits<double>::infinity();
  work();
  for (const double end = ProcessorSeconds() + seconds; ProcessorSeconds() < end;) {
    const double start = ProcessorSeconds();
    work();
    best = std::min(best, ProcessorSeconds() - start);
  }
  return best;
}

volatile double kept;  // a result that somebody might want

// What one core can do.
struct Machine {
  double flops, division, root, bandwidth;  // 1/s, s, s, byte/s
};

// What was better of two measurements: others work on this computer too.
void Improve(double seconds, Machine& machine) {
  constexpr std::size_t kRounds = 1 << 16, kChains = 12, kNumbers = 1 << 25;  // 256 MiB
  const double lanes = static_cast<double>(HWY_DYNAMIC_DISPATCH(Lanes)());
  const double operations = lanes * static_cast<double>(kChains * kRounds);
  const auto of_one = [&](const Work& work) { return Fastest(work, seconds) / operations; };
  machine.flops =
      std::max(machine.flops, 2 / of_one([] { kept = HWY_DYNAMIC_DISPATCH(Fused)(kRounds); }));
  machine.division =
      std::min(machine.division, of_one([] { kept = HWY_DYNAMIC_DISPATCH(Divided)(kRounds); }));
  machine.root =
      std::min(machine.root, of_one([] { kept = HWY_DYNAMIC_DISPATCH(Rooted)(kRounds); }));
  const std::vector<double> from(kNumbers, 1.0);
  std::vector<double> to(kNumbers, 0.0);
  const auto copy = [&] { kept = HWY_DYNAMIC_DISPATCH(Copied)(from.data(), kNumbers, to.data()); };
  machine.bandwidth =
      std::max(machine.bandwidth,
               3 * sizeof(double) * static_cast<double>(kNumbers) / Fastest(copy, seconds));
}

void Print(const Machine& machine) {
  fmt::print(
      "one core: {:.1f} Gflop/s with fused multiply-adds on {} lanes, {:.2f} ns a division, "
      "{:.2f} ns a root, {:.1f} GB/s of memory\n{:<20}{:<8}{:>8}{:>7}{:>9}{:>9}{:>9}{:>10}{:>9}  "
      "{}\n",
      1e-9 * machine.flops, HWY_DYNAMIC_DISPATCH(Lanes)(), 1e9 * machine.division,
      1e9 * machine.root, 1e-9 * machine.bandwidth, "kernel", "place", "flops", "bytes", "flops ns",
      "div ns", "mem ns", "took ns", "Gflop/s", "of its limit");
}

// What one item takes.
struct Needs {
  double flops, divisions, roots, numbers_read, numbers_written;
};

struct Timed {
  std::string kernel;
  bool from_memory;
  Needs needs;
  double seconds;
};

void Print(const Timed& timed, const Machine& machine) {
  const auto& [kernel, from_memory, needs, seconds] = timed;
  const double bytes = sizeof(double) * (needs.numbers_read + 2 * needs.numbers_written);
  const double arithmetic = needs.flops / machine.flops,
               divider = needs.divisions * machine.division + needs.roots * machine.root,
               memory = from_memory ? bytes / machine.bandwidth : 0.0;
  const double limit = std::max({arithmetic, divider, memory});
  fmt::print("{:<20}{:<8}{:>8.0f}{:>7.0f}{:>9.2f}{:>9.2f}{:>9.2f}{:>10.2f}{:>9.2f}  {:>3.0f} %\n",
             kernel, from_memory ? "memory" : "cache", needs.flops, bytes, 1e9 * arithmetic,
             1e9 * divider, 1e9 * memory, 1e9 * seconds, 1e-9 * needs.flops / seconds,
             100.0 * limit / seconds);
}

// Makes the work on so many items.
using Maker = std::function<Work(Index count)>;

Work HeadInversion(Index count) {
  struct State {
    probes::SmallAngleInversion invert{probes::NominalLayout(), probes::MovingBody::kTarget};
    probes::SmallAngleInversion::Readings readings;
    Eigen::VectorXd d;
    probes::SmallAngleInversion::Errors errors;
  };
  const auto state = std::make_shared<State>();
  state->readings = 1e-5 * probes::SmallAngleInversion::Readings::Random(count, 5);
  state->d = Eigen::VectorXd::LinSpaced(count, 0.0, 60e-3);
  return [state] {
    state->invert.Invert(state->readings, state->d, Eigen::VectorXd(), state->errors);
  };
}

Work LinkageForward(Index count) {
  struct State {
    relm::PivotLinkage linkage{0.12, 0.12};
    Eigen::Matrix3Xd q, p;
  };
  const auto state = std::make_shared<State>();
  state->q = Eigen::Matrix3Xd::Random(3, count);
  return [state] { state->linkage.Tips(state->q, state->p); };
}

const Eigen::Vector3d kTool(0.05, -0.04, 0.1);

Eigen::Matrix3Xd Positions(Index count) {
  return (0.5 * kTravel * (1.0 + Eigen::Array3Xd::Random(3, count))).matrix();
}

Work MapExact(Index count) {
  const auto field = std::make_shared<machine::VolumetricField>(ColumnMachine());
  return [field, positions = Positions(count)] { kept = field->Errors(positions, kTool)(0, 0); };
}

Work MapWithSlopes(Index count) {
  const auto field = std::make_shared<machine::VolumetricField>(ColumnMachine());
  const auto linear = std::make_shared<machine::VolumetricField::Linearized>();
  return [field, linear, positions = Positions(count)] {
    field->Linearize(positions, kTool, *linear);
  };
}

struct Kernel {
  std::string name;
  Needs needs;
  Maker make;
  Index in_cache, in_memory;  // items
};

// The candidates of a reduced standard campaign of the demonstration mill, all together.
class Projection {
 public:
  Projection() : campaign_(MakeCampaign()), fit_(campaign_) {
    for (const auto& each : diagnosis::AllCandidates(campaign_.scene())) {
      if (each.cause->columns && !each.cause->relaxes) candidates_.push_back(each);
    }
    for (const auto& each : candidates_) columns_ += each.cause->coefficients();
  }

  Index columns() const { return columns_; }
  void Run() const { kept = diagnosis::ScoreAll(fit_, candidates_).front().log_evidence; }

  // Flops of all columns.
  double Flops() const {
    const std::vector<double> parameters = ParametersOfRuns();
    const double n = static_cast<double>(fit_.result().names.size());
    double flops = static_cast<double>(columns_) * n * n;
    for (std::size_t run = 0; run < fit_.runs(); ++run) {
      const simulation::Trace& trace = fit_.TraceOf(run);
      if (trace.rows() == 0 || !campaign_.runs()[run].simulated.response) continue;
      double rows = 0.0;
      for (const auto& each : candidates_) {
        for (const auto& column : each.cause->columns(trace, each.object, each.shape)) {
          rows += static_cast<double>(column.stages().size() * trace.rows());
        }
      }
      flops += 2 * rows * (parameters[run] + 1);
    }
    return flops;
  }

 private:
  static diagnosis::Campaign MakeCampaign() {
    const auto document = settings::Document::Read(std::filesystem::path(ABBE_SOURCE_DIR) /
                                                   "machines/demo_mill.toml");
    const auto root = document.Root();
    auto world = rig::RecordCampaign(rig::ReadCampaignMachine(root), 1, {},
                                     {.kind = rig::CampaignKind::kStandard, .reduced = true});
    diagnosis::Campaign campaign({machine::ReadMachine(root), probes::ReadHeadSettings(root),
                                  probes::ReadTargetSettings(root), probes::ReadProbeNoise(root),
                                  relm::ReadLinkageSettings(root)});
    campaign.Add(std::move(world.recordings));
    return campaign;
  }

  // Those that a run depends on.
  std::vector<double> ParametersOfRuns() const {
    std::vector<simulation::SimulatedRun> runs;
    for (const auto& run : campaign_.runs()) runs.push_back(run.simulated);
    const auto problem = fusion::MakeMachineProblem(campaign_.instruments().machine,
                                                    campaign_.model(), campaign_.prior(), runs);
    const estimation::Layout layout(problem);
    const auto x = fusion::ValuesFound(fit_.result(), fit_.result().blocks);
    estimation::RowEvaluator evaluator(problem, layout);
    std::vector<double> counts;
    for (std::size_t run = 0; run < runs.size(); ++run) {
      const auto& J = evaluator.Evaluate(problem.terms()[run], x, true)->jacobian;
      counts.push_back(static_cast<double>((J.cwiseAbs().colwise().sum().array() > 0.0).count()));
    }
    return counts;
  }

  diagnosis::Campaign campaign_;
  diagnosis::Fit fit_;
  std::vector<diagnosis::Candidate> candidates_;
  Index columns_ = 0;
};

}  // namespace
}  // namespace abbe::bench

int main(int argc, char** argv) {
  using namespace abbe::bench;
  const double seconds = argc > 1 ? std::atof(argv[1]) : 0.5;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  Machine machine{.flops = 0.0, .division = kNone, .root = kNone, .bandwidth = 0.0};
  std::vector<Timed> all;
  const std::vector<Kernel> kernels{
      {"head inversion", {74, 4, 1, 6, 6}, HeadInversion, 1 << 10, 1 << 21},
      {"linkage forward", {122, 0, 0, 3, 3}, LinkageForward, 1 << 10, 1 << 22},
      {"map, exact", {3 * (36 + 4 + 47 + 11) + 9, 0, 0, 3, 3}, MapExact, 1 << 10, 1 << 21},
      {"map with 81 slopes",
       {3 * (36 + 4 + 42 + 47 + 11 + 316) + 89, 0, 0, 3, 84},
       MapWithSlopes,
       1 << 8,
       1 << 18},
  };
  for (const Kernel& kernel : kernels) {
    for (const bool in_cache : {true, false}) {
      const Eigen::Index count = in_cache ? kernel.in_cache : kernel.in_memory;
      const double time = Fastest(kernel.make(count), seconds) / static_cast<double>(count);
      all.push_back({kernel.name, !in_cache, kernel.needs, time});
      Improve(0.5 * seconds, machine);
    }
  }
  const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
  const Projection projection;
  const double columns = static_cast<double>(projection.columns());
  const double time = Fastest([&] { projection.Run(); }, seconds) / columns;
  all.push_back({"projection", false, {projection.Flops() / columns, 0, 0, 0, 0}, time});
  Improve(0.5 * seconds, machine);
  Print(machine);
  for (const Timed& each : all) Print(each, machine);
  return 0;
}
#endif  // HWY_ONCE
