// abbe investigate: chooses the next run, gets it recorded, diagnoses, and again.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/diagnosis_result.h"
#include "apps/instruments.h"
#include "apps/investigate_recorders.h"
#include "apps/result_file.h"
#include "apps/working_line.h"
#include "failure/failure.h"
#include "investigate/investigation.h"
#include "recording/file_hash.h"
#include "recording/instant.h"
#include "rig/record_sweep.h"

namespace abbe::apps {
namespace {

namespace fs = std::filesystem;

struct InvestigateArguments {
  fs::path machine, out;
  std::string budget = "45min", rig;
  bool devices = false, quiet = false;
};

// Minutes of "45min", "1.5h" or "90".
double BudgetMinutes(const std::string& text) {
  std::size_t end = 0;
  double value = 0.0;
  try {
    value = std::stod(text, &end);
  } catch (const std::exception&) {
    end = 0;
  }
  const std::string unit = text.substr(end);
  if (end == 0 || !(value > 0.0) || (!unit.empty() && unit != "min" && unit != "h")) {
    throw InputError(
        fmt::format("--budget {}: give minutes or hours, such as 45min or 1.5h", text));
  }
  return unit == "h" ? 60.0 * value : value;
}

investigate::Subject SubjectOf(const MachineFile& file, double budget) {
  investigate::Subject subject{.instruments = InstrumentsOf(file), .budget = budget};
  subject.costs = investigate::ReadCosts(file.document.Root(), subject.instruments);
  for (const auto& channel : rig::ChannelsOf(file.devices)) {
    if (channel.name.starts_with("temp_")) subject.sensors.push_back(channel.name);
  }
  return subject;
}

// The rig by a hash: the folder must not say what is hidden.
std::string RecorderName(const InvestigateArguments& arguments) {
  return arguments.rig.empty() ? "devices" : "rig " + recording::Sha256OfText(arguments.rig);
}

int Investigate(const InvestigateArguments& arguments) {
  if (arguments.rig.empty() != arguments.devices) {
    throw InputError(
        "investigate: say who records: --devices for a machine and its operator, or --rig "
        "seed=7 for the virtual rig");
  }
  const MachineFile file = ReadMachineFile(arguments.machine);
  const investigate::Subject subject = SubjectOf(file, BudgetMinutes(arguments.budget));
  const auto recorder =
      arguments.devices ? OperatorRecorder() : RigRecorder(file, ParseRigOption(arguments.rig));
  investigate::Journal journal = investigate::Journal::In(
      arguments.out, {subject.instruments.machine.name, RecorderName(arguments),
                      recording::SecondsOf(recording::UtcNow()).value_or(0.0)});
  const auto show = [&](const std::string& line) {
    if (arguments.quiet) return;
    WorkingLine::Erase();
    fmt::print("{}\n", line);
    std::fflush(stdout);
  };
  // An operator is asked on the same terminal.
  std::optional<WorkingLine> line(std::in_place, "investigate",
                                  arguments.quiet || arguments.devices);
  const investigate::Ended ended = investigate::Investigate(subject, *recorder, journal, show);
  line.reset();
  if (ended.diagnosis && ended.why != investigate::Why::kWaiting) {
    auto json = DiagnosisJson(*ended.diagnosis, ended.gain);
    json["abbe"] = ABBE_VERSION;
    json["machine"] = subject.instruments.machine.name;
    for (const auto& path : journal.recordings()) {
      json["recordings"].push_back(path.filename().string());
    }
    WriteResult(json, arguments.out / "diagnosis.json");
    if (!arguments.quiet) fmt::print("\n{}", DiagnosisText(*ended.diagnosis, ended.gain));
  }
  if (!arguments.quiet) {
    fmt::print("\n{}: {:.1f} of {:g} min, {}\n", arguments.out.string(), journal.spent(),
               subject.budget, Text(ended.why));
  }
  return kDone;
}

}  // namespace

void AddInvestigate(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<InvestigateArguments>();
  CLI::App* command = program.add_subcommand(
      "investigate",
      "Begins with nothing but the machine file: chooses the run that tells most a minute, gets it "
      "recorded, diagnoses, and chooses again");
  command->add_option("--machine", arguments->machine, "Machine file")->required();
  command->add_option("--out", arguments->out, "Folder of the journal and the recordings")
      ->required();
  command->add_option("--budget", arguments->budget, "Time at the machine: 45min, 1.5h")
      ->capture_default_str();
  auto* rig = command->add_option("--rig", arguments->rig,
                                  "The virtual rig records: seed=7,hide=EFFECT (hide may be "
                                  "repeated; docs/virtual-rig.md)");
  command
      ->add_flag("--devices", arguments->devices,
                 "A machine: programs for the control are written, and an operator is asked for "
                 "each recording")
      ->excludes(rig);
  command->add_flag("--quiet", arguments->quiet, "No tables");
  command->footer(
      "Example: abbe investigate --machine mill.toml --budget 45min --out found --devices\n"
      "         abbe investigate --machine machines/demo_mill.toml --budget 60min --out found "
      "--rig seed=7,hide=backlash:object=X");
  command->callback([arguments, &exit_code] { exit_code = Investigate(*arguments); });
}

}  // namespace abbe::apps
