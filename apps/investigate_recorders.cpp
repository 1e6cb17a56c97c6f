#include "apps/investigate_recorders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <optional>
#include <string>

#include "apps/result_file.h"
#include "failure/failure.h"
#include "investigate/control_program.h"
#include "recording/instant.h"
#include "recording/recording_file.h"
#include "rig/planned_recorder.h"
#include "simulation/planned_paths.h"

namespace abbe::apps {
namespace {

namespace fs = std::filesystem;
using investigate::Journal;
using recording::Recording;

std::string PathName(const Recording& path, const Journal& journal) {
  return fmt::format("{:02}_{}{}.h5", journal.number(), path.Kind(),
                     path.HeaderText("axis") ? "_" + *path.HeaderText("axis") : "");
}

class OfRig : public investigate::Recorder {
 public:
  OfRig(const MachineFile& file, const RigOption& option)
      : machine_(rig::ReadCampaignMachine(file.document.Root())), seed_(option.seed) {
    for (const std::string& text : option.hide) {
      hidden_.push_back(rig::ParseHidden(text, seed_, machine_.sensors));
    }
  }

  bool Records(const Recording& path) const override {
    return rig::PlannedRecorder(machine_, seed_, hidden_, 0.0).Records(path);
  }

  std::optional<std::string> Record(const Recording& path, const Journal& journal) override {
    if (!recorder_) recorder_.emplace(machine_, seed_, hidden_, journal.started());
    const std::string name = PathName(path, journal);
    // What an interrupted call left without an entry is recorded again, and the same.
    std::error_code ignored;
    fs::remove(journal.folder() / name, ignored);
    recording::Write(recorder_->Record(path, journal.number()), journal.folder() / name);
    return name;
  }

 private:
  rig::CampaignMachine machine_;
  std::uint64_t seed_;
  rig::HiddenEffects hidden_;
  std::optional<rig::PlannedRecorder> recorder_;
};

class ByOperator : public investigate::Recorder {
 public:
  bool Records(const Recording&) const override { return true; }

  double Begin(double planned) const override {
    return std::max(planned, recording::SecondsOf(recording::UtcNow()).value_or(planned));
  }

  std::optional<std::string> Record(const Recording& path, const Journal& journal) override {
    const fs::path program = journal.folder() / fmt::format("{:02}.ngc", journal.number());
    WriteText(investigate::ControlProgram(path, journal.WaitingText()), program);
    Prompt(path, program, journal);
    for (std::string line; std::getline(std::cin, line);) {
      if (line.empty()) continue;
      try {
        return Kept(line, path, journal);
      } catch (const InputError& error) {
        fmt::print(stderr, "abbe: {}\n", error.what());
      }
      Ask();
    }
    fmt::print("\nIt waits to be recorded; call the same command again.\n");
    return {};
  }

 private:
  static void Prompt(const Recording& path, const fs::path& program, const Journal& journal) {
    const auto axis = path.HeaderText("axis");
    fmt::print(
        "\n{}. {}\n   program for the control (LinuxCNC): {}\n   record it meanwhile as kind "
        "\"{}\"{}, {:.0f} s\n",
        journal.number(), journal.WaitingText(), program.string(), path.Kind(),
        axis ? " of " + *axis : "", simulation::DurationOf(path));
    Ask();
  }

  static void Ask() {
    fmt::print("   the recording: ");
    std::fflush(stdout);
  }

  // A recording of the kind that was asked for, beside the others.
  static std::string Kept(const fs::path& given, const Recording& path, const Journal& journal) {
    Recording made = recording::Read(given);
    if (made.Kind() != path.Kind()) {
      throw InputError(
          fmt::format("{}: is of kind \"{}\"; this run is a \"{}\": give its recording",
                      given.string(), made.Kind(), path.Kind()));
    }
    const std::string name = PathName(path, journal);
    const fs::path target = journal.folder() / name;
    std::error_code error;
    if (fs::exists(target) && fs::equivalent(given, target, error)) return name;
    if (fs::exists(target)) fs::remove(target, error);
    made.name = name;
    recording::Write(made, target);
    return name;
  }
};

}  // namespace

std::unique_ptr<investigate::Recorder> RigRecorder(const MachineFile& file,
                                                   const RigOption& option) {
  return std::make_unique<OfRig>(file, option);
}

std::unique_ptr<investigate::Recorder> OperatorRecorder() { return std::make_unique<ByOperator>(); }

}  // namespace abbe::apps
