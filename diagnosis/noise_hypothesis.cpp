#include "diagnosis/noise_hypothesis.h"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>

#include "simulation/remembered_noise.h"

namespace abbe::diagnosis {
namespace {

constexpr double kShown = 10.0;                 // logarithm of the likelihood
constexpr double kMostSteps = 40.0;             // rows, of a memory
constexpr double kFewestRows = 60.0;            // of a run that tells
const double kPriorOfMemory = std::log(kElse);  // in a run

std::optional<estimation::NoiseMemory> MemoryOf(const Fit& fit, std::size_t r) {
  const PreparedRun& run = fit.campaign().runs()[r];
  const auto& left = fit.LeftOf(r);
  const double rows = run.trace.rows();
  if (run.trace.head || run.trace.rim || run.memory || !run.simulated.response ||
      rows < kFewestRows || left.size() % run.trace.rows() != 0) {
    return {};
  }
  const auto found = estimation::FitMemory(simulation::ChannelsOf(left, run.trace.time));
  if (found.gain < kShown || found.noise.time > kMostSteps * found.step) return {};
  return found.noise;
}

// The prior of the memories of all runs, with what whitening by them does to the likelihood.
double PriorOfMemories(const Campaign& campaign) {
  double prior = 0.0;
  for (const PreparedRun& run : campaign.runs()) {
    if (!run.memory) continue;
    const auto& times = run.trace.time;
    const double values = run.simulated.residual->Rows();
    const double channels = values / times.size();
    const estimation::MemoryFilter filter(times, *run.memory);
    prior += kPriorOfMemory - 0.5 * channels * filter.log_determinant();
  }
  return prior;
}

std::string NoteOf(const PreparedRun& run, const estimation::NoiseMemory& noise) {
  const double share = std::pow(noise.slow / noise.sd(), 2);
  return fmt::format(
      "{}: what is left goes on from one row to the next: {:.0f} % of its variance fades within "
      "{:.2g} s, and counts as so many fewer rows",
      run.simulated.name, 100.0 * share, noise.time);
}

}  // namespace

Answer BesideMemory(Answer white) {
  if (white.diagnosis.verdict != Verdict::kUnexplained) return white;
  const Campaign& campaign = *white.campaign;
  const auto remembering = std::make_shared<Campaign>(campaign);
  std::vector<std::string> notes = white.diagnosis.notes;
  bool any = false;
  for (std::size_t run = 0; run < campaign.runs().size(); ++run) {
    // What structures explain was no memory.
    if (!MemoryOf(white.search->fit(), run)) continue;
    const auto memory = MemoryOf(white.search->base(), run);
    if (!memory) continue;
    notes.push_back(NoteOf(campaign.runs()[run], *memory));
    remembering->SetMemory(run, *memory);
    any = true;
  }
  if (!any) return white;
  Answer other = Ask(remembering, std::make_shared<Search>(*remembering),
                     white.prior + PriorOfMemories(*remembering));
  if (other.worth < white.worth) return white;
  other.diagnosis.notes = std::move(notes);
  return other;
}

}  // namespace abbe::diagnosis
