// `abbe align`: sets head and target up for the sweep of an axis, with the operator at its screws.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "apps/align_operator.h"
#include "apps/align_result.h"
#include "apps/command.h"
#include "apps/commands.h"
#include "apps/interrupt.h"
#include "apps/live_view.h"
#include "apps/machine_file.h"
#include "apps/mounting_file.h"
#include "apps/plausible_channels.h"
#include "apps/result_file.h"
#include "hal/combined_source.h"
#include "hal/standstill.h"
#include "probes/head_alignment.h"
#include "recording/instant.h"
#include "settings/unit.h"

namespace abbe::apps {
namespace {

using probes::kProbes;
using settings::kMicrometre;
using settings::kMillimetre;

constexpr double kBeyondStale = 0.5;  // s more than [devices] stale_ms: a frozen register shows
constexpr int kRefusedInARow = 4;     // places without all gaps, before the turns are doubted
constexpr double kLeastGood = 0.5;    // of the readings of a channel

struct AlignCommand {
  std::string axis, machine, mounting;
  std::filesystem::path out = "out";
  std::string json;
  double clock_speed = 1.0;
  bool as_is = false;
  bool quiet = false;
  LiveOptions live;
};

class Alignment {
 public:
  Alignment(const AlignCommand& options, const MachineFile& file, const hal::SweepPlan& plan,
            hal::Clock& clock, hal::SampleSource& source, LiveView* view)
      : options_(options),
        file_(file),
        plan_(plan),
        view_(view),
        channels_(source.channels(), plan.axis, options.machine),
        operator_(channels_, plan.axis, file.devices.rate, clock, source, view),
        aligner_(file.sweep_setup.machine, file.sweep_setup.head, file.align, plan.axis,
                 plan.first(), plan.last()) {
    status_.axis = plan.axis;
    status_.machine = file.sweep_setup.machine.name;
    status_.started = recording::UtcNow();
    status_.first = plan.first();
    status_.last = plan.last();
  }

  const AlignStatus& Run() {
    bool from_last = false;
    status_.end = AlignEnd::kGoesOn;
    while (status_.end == AlignEnd::kGoesOn) {
      const bool read = ReadAt(from_last ? plan_.last() : plan_.first()) &&
                        ReadAt(from_last ? plan_.first() : plan_.last());
      from_last = !from_last;
      if (status_.end != AlignEnd::kGoesOn) break;
      if (!read || !Judge()) status_.end = AlignEnd::kStopped;
    }
    return status_;
  }

 private:
  // The result so far, for the page.
  void ShowResult() {
    if (view_ == nullptr) return;
    view_->Show(fmt::format("align_{:c}.json", plan_.axis), AlignJson(status_, file_.align));
  }

  // Reads at a place near `goal` when the operator has confirmed it; false when it ends.
  bool ReadAt(double goal) {
    const double seconds = std::max(plan_.dwell, file_.devices.stale + kBeyondStale);
    int refused = 0;
    while (true) {
      operator_.Ask(fmt::format(
          "move {:c} to {:.6g} mm, or as far towards it as all five gaps are shown, then "
          "press Enter",
          plan_.axis, goal / kMillimetre));
      const auto standstill = operator_.AwaitStandstill(seconds);
      if (!standstill) return false;
      const std::string refusal = Take(*standstill, goal);
      if (status_.end != AlignEnd::kGoesOn) return false;
      if (refusal.empty()) return true;
      fmt::print(stderr, "abbe: {}\n", refusal);
      if (++refused < kRefusedInARow || status_.turned.empty() || status_.turned.back().empty() ||
          status_.readings.back().setting == static_cast<int>(status_.turned.size())) {
        continue;
      }
      refused = 0;
      if (!TurnedHalfBack()) return false;
    }
  }

  // Wrong turns, because of wrong wires, can leave no place where all gaps are shown.
  bool TurnedHalfBack() {
    fmt::print(
        "after the last turns no place shows all five gaps, as with a wrong sign: take half of "
        "them back\n");
    const auto back = half_back_ ? status_.turned.back() : HalfBack(status_.turned.back());
    half_back_ = true;
    return Turned(back);
  }

  // Takes the readings in; else why not.
  std::string Take(const hal::Standstill& standstill, double goal) {
    probes::GapsAt at{.setting = static_cast<int>(status_.turned.size())};
    double position = goal;
    if (channels_.position) {
      const auto found = PositionOf(standstill);
      if (!found) {
        return fmt::format(
            "{:c} moved while it was read, or gives no position: let it stand and "
            "press Enter again",
            plan_.axis);
      }
      position = *found;
    }
    at.travel = aligner_.TravelOf(position);
    for (std::size_t i = 0; i < kProbes; ++i) {
      const std::size_t channel = channels_.gap[i];
      const bool good =
          standstill.good[channel] >= kLeastGood * static_cast<double>(standstill.readings());
      if (!good) return Unread(i, standstill.cause[channel], position);
      status_.noise[i] = probes::NoiseOf(standstill.times, standstill.values[channel]);
      status_.noise[i].mean *= kMicrometre;
      status_.noise[i].noise *= kMicrometre;
      status_.noise[i].mains *= kMicrometre;
      at.gap[i] = status_.noise[i].mean;
    }
    status_.readings.push_back(at);
    if (!options_.quiet) {
      fmt::print("{:c} {:.3f} mm:", plan_.axis, position / kMillimetre);
      for (const double gap : at.gap) fmt::print(" {:.1f}", gap / kMicrometre);
      fmt::print(" um\n");
    }
    return {};
  }

  // A channel without a gap: out of its range for now, or dead for good.
  std::string Unread(std::size_t probe, hal::Cause cause, double position) {
    const std::string name = fmt::format("probe_{:c}", 'a' + probe);
    switch (cause) {
      case hal::Cause::kFrozen:
      case hal::Cause::kStale:
        status_.wiring = {fmt::format("{} does not move: its register has not changed for {:.3g} s",
                                      name, file_.devices.stale)};
        break;
      case hal::Cause::kNoReply:
      case hal::Cause::kRefused:
      case hal::Cause::kSensorFault:
      case hal::Cause::kNotANumber:
        status_.wiring = {fmt::format("{} gives no reading: {}", name, hal::NameOf(cause))};
        break;
      default:
        return fmt::format(
            "{} shows no gap at {:.3f} mm ({}): move {:c} back until all five do, or bring head and "
            "target nearer by hand, then press Enter; if it shows none anywhere, look at its cable",
            name, position / kMillimetre, hal::NameOf(cause), plan_.axis);
    }
    status_.end = AlignEnd::kWrongWiring;
    return {};
  }

  // m; nothing when the axis did not stand, or gave no position.
  std::optional<double> PositionOf(const hal::Standstill& standstill) const {
    const auto& values = standstill.values[*channels_.position];
    double low = INFINITY, high = -INFINITY;
    for (const double value : values) {
      if (std::isnan(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    if (!(high - low <= plan_.window / kMillimetre)) return {};
    return 0.5 * (low + high) * kMillimetre;
  }

  // What the wiring may be judged from: without screws nothing is known between two settings.
  probes::WiringFinding Wiring() const {
    if (!file_.align.screws.empty()) {
      return probes::FindWiring(status_.readings, status_.turned, aligner_);
    }
    std::vector<probes::GapsAt> last;
    for (probes::GapsAt at : status_.readings) {
      if (at.setting != status_.readings.back().setting) continue;
      at.setting = 0;
      last.push_back(at);
    }
    return probes::FindWiring(last, {}, aligner_);
  }

  // Says what was found and has the operator turn the screws; false when that ends it.
  bool Judge() {
    half_back_ = false;
    const probes::WiringFinding wiring = Wiring();
    status_.wiring.clear();
    status_.open.clear();
    for (const probes::Wiring& wrong : wiring.wrong) status_.wiring.push_back(NameOf(wrong));
    for (const probes::Wiring& open : wiring.open) status_.open.push_back(NameOf(open));
    if (!wiring.wrong.empty()) return JudgeWiring(wiring);
    status_.alignment = aligner_.Evaluate(status_.readings);
    status_.notes = NoiseNotes(status_.noise, file_.sweep_setup.noise.probe);
    if (!status_.open.empty()) {
      status_.notes.push_back(fmt::format("the turns were too small to exclude that {}",
                                          fmt::join(status_.open, ", or that ")));
    }
    if (!options_.quiet) fmt::print("{}", AlignTable(status_, file_.align));
    switch (status_.alignment->verdict) {
      case probes::AlignVerdict::kReady:
        if (WiringIsUntested()) {
          if (!status_.alignment->turns.empty()) {
            fmt::print(
                "in range; these turns bring the gaps to the middle and prove the wiring "
                "(--as-is: without)\n");
            return Turned(status_.alignment->turns);
          }
        }
        status_.end = AlignEnd::kReady;
        return true;
      case probes::AlignVerdict::kTravelUnseen:
        fmt::print("{:.0f} % of the travel seen: look at the rest of it\n",
                   100.0 * status_.alignment->seen);
        return true;
      case probes::AlignVerdict::kTurn:
        return Turned(status_.alignment->turns);
      case probes::AlignVerdict::kOutOfReach:
        status_.end = AlignEnd::kOutOfReach;
        return true;
    }
    return false;
  }

  // Nothing was turned, neither now nor before the mounting that the folder states.
  bool WiringIsUntested() const {
    return status_.turned.empty() && !options_.as_is && !ReadMounting(options_.out);
  }

  bool JudgeWiring(const probes::WiringFinding& wiring) {
    const auto test = wiring.wrong.size() > 1
                          ? TestTurn(wiring.wrong, status_.readings.back(), aligner_)
                          : std::nullopt;
    if (!test) {
      status_.end = AlignEnd::kWrongWiring;
      return true;
    }
    fmt::print("the wiring is wrong: {}; a turn tells which\n", fmt::join(status_.wiring, ", or "));
    return Turned({*test});
  }

  bool Turned(const std::vector<probes::ScrewTurn>& turns) {
    const probes::HeadAlignment none;
    const auto lines = TurnLines(turns, status_.alignment ? *status_.alignment : none, file_.align);
    for (const std::string& line : lines) fmt::print("turn: {}\n", line);
    operator_.Ask("then press Enter");
    if (view_ != nullptr) {
      view_->Show({.note = fmt::format("Turn {}; then press Enter at the terminal",
                                       fmt::join(lines, ", "))});
    }
    ShowResult();
    if (!operator_.AwaitStandstill(0.0)) return false;
    status_.turned.push_back(turns);
    return true;
  }

  const AlignCommand& options_;
  const MachineFile& file_;
  const hal::SweepPlan& plan_;
  LiveView* view_;
  GapChannels channels_;
  AlignOperator operator_;
  probes::HeadAligner aligner_;
  AlignStatus status_;
  bool half_back_ = false;  // the last turns were
};

// The set-up has the name that was given; else it is a new one when a screw was turned.
MountingFile MountingOf(const AlignCommand& options, const AlignStatus& status) {
  MountingFile mounting = ReadMounting(options.out).value_or(MountingFile{});
  const bool another = mounting.id.empty() || !status.turned.empty() ||
                       (!options.mounting.empty() && options.mounting != mounting.id);
  if (another) mounting = {options.mounting.empty() ? status.started : options.mounting, {}};
  mounting.aligned[status.axis] = {status.started, status.alignment->top.value,
                                   status.alignment->side.value};
  return mounting;
}

void PrintEnd(const AlignStatus& status) {
  for (const std::string& note : status.notes) fmt::print(stderr, "abbe: {}\n", note);
  switch (status.end) {
    case AlignEnd::kReady:
      fmt::print("ready: the whole travel lies in range after {} adjustments; mounting \"{}\"\n",
                 status.turned.size(), status.mounting);
      return;
    case AlignEnd::kWrongWiring:
      fmt::print(
          "not ready: {}; correct the cables, or the channels of the machine file, and "
          "align again\n",
          fmt::join(status.wiring, ", or "));
      return;
    case AlignEnd::kOutOfReach:
      for (std::size_t i = 0; i < kProbes; ++i) {
        const probes::GapOutlook& after = status.alignment->after[i];
        const double off = 0.5 * (after.first + after.last - after.range);
        fmt::print(
            "probe_{:c}: the screws leave {:.1f} to {:.1f} um of {:.0f}: {:+.1f} um from the "
            "middle\n",
            'a' + i, std::min(after.first, after.last) / kMicrometre,
            std::max(after.first, after.last) / kMicrometre, after.range / kMicrometre,
            off / kMicrometre);
      }
      fmt::print(
          "not ready: the screws cannot bring the travel into the ranges: move the probes in "
          "their holders by these amounts and align again\n");
      return;
    default:
      fmt::print("not ready: ended before the travel lay in range\n");
  }
}

int Align(const AlignCommand& options) {
  const MachineFile file = ReadMachineFile(options.machine);
  file.RequireDevices();
  const hal::SweepPlan& plan = file.SweepPlanOf(options.axis[0]);
  InterruptFlag();
  hal::SteadyClock clock(options.clock_speed);
  const PlausibleDevices opened =
      OpenPlausible(file, hal::WithoutEncoders(file.devices), kFirstReadings, clock);
  const hal::OpenedDevices& devices = opened.devices;
  hal::PlausibleSource& source = *opened.source;
  for (const std::string& warning : opened.warnings) fmt::print(stderr, "abbe: {}\n", warning);
  std::filesystem::create_directories(options.out);
  const auto view =
      OpenLive(options.live, {.title = fmt::format("Setting up for the {} axis", options.axis),
                              .folder = options.out,
                              .ranges = GapRanges(file)});
  Alignment alignment(options, file, plan, clock, source, view.get());
  AlignStatus status = alignment.Run();
  for (const auto& [device, description] : devices.transport) {
    status.simulated = status.simulated || description.find("simulated") != std::string::npos;
  }
  if (status.end == AlignEnd::kReady) {
    const MountingFile mounting = MountingOf(options, status);
    status.mounting = mounting.id;
    WriteMounting(mounting, options.out);
  }
  WriteResult(AlignJson(status, file.align),
              options.json.empty() ? options.out / fmt::format("align_{}.json", options.axis)
                                   : std::filesystem::path(options.json));
  if (view) view->End(status.end == AlignEnd::kReady ? "Ready" : "Not ready");
  PrintEnd(status);
  return status.end == AlignEnd::kReady ? kDone : kRequirementNotMet;
}

}  // namespace

void AddAlign(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<AlignCommand>();
  CLI::App* command =
      program.add_subcommand("align", "Set up head and target for the sweep of an axis");
  command->add_option("--axis", options->axis, "the axis: X, Y or Z")
      ->required()
      ->check(CLI::IsMember({"X", "Y", "Z"}));
  command->add_option("--machine", options->machine, "the machine file")->required();
  command->add_option("--out", options->out, "folder of the result and of the sweeps that follow")
      ->capture_default_str();
  command->add_option("--json", options->json, "the result as data (default: OUT/align_AXIS.json)");
  command->add_option("--mounting", options->mounting,
                      "name of this set-up of head and target (default: the time, new whenever a "
                      "screw was turned)");
  command
      ->add_option("--clock-speed", options->clock_speed,
                   "for a virtual machine that runs faster by this factor")
      ->check(PositiveNumber());
  command->add_flag("--as-is", options->as_is,
                    "accept a set-up that is in range without any turn, which leaves the wiring of "
                    "one face untested");
  AddLiveOptions(*command, options->live);
  command->add_flag("--quiet", options->quiet, "print nothing but what to do and problems");
  command->footer("Example: abbe align --axis X --machine mill.toml --out measured");
  command->callback([options, &exit_code] { exit_code = Align(*options); });
}

}  // namespace abbe::apps
