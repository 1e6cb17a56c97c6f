// `abbe init`: writes a commented machine file, or says what one lacks for which command.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/linuxcnc_ini.h"
#include "apps/machine_template.h"
#include "apps/readiness.h"
#include "apps/result_file.h"
#include "failure/failure.h"

namespace abbe::apps {
namespace {

struct InitCommand {
  std::string kind, name, positive, chain;
  std::vector<double> travel_mm[3];
  std::filesystem::path ini, check, out = "machine.toml";
  bool has_head = false, asks = false, force = false;
  std::vector<char> unstated;  // axes whose travel is an example
};

int CheckReadiness(const std::filesystem::path& path) {
  for (const CommandReadiness& each : ReadinessOf(settings::Document::Read(path))) {
    if (each.missing.empty()) {
      fmt::print("{}: ready\n", each.commands);
      continue;
    }
    fmt::print("{}: missing {}\n", each.commands, fmt::join(each.missing, "; "));
  }
  return kDone;
}

// The answer to a question; `fallback` for an empty one. InputError at the end of the answers.
std::string Answer(const std::string& question, const std::string& fallback) {
  fmt::print("{} [{}]: ", question, fallback);
  std::fflush(stdout);
  std::string answer;
  if (!std::getline(std::cin, answer)) {
    throw InputError(
        fmt::format("no answer to \"{}\"; give options instead, see abbe init --help", question));
  }
  return answer.empty() ? fallback : answer;
}

std::pair<double, double> TravelAnswer(char axis, std::pair<double, double> fallback) {
  const std::string answer =
      Answer(fmt::format("Travel of {} as the control shows it, from,to in mm", axis),
             fmt::format("{:g},{:g}", fallback.first, fallback.second));
  std::pair<double, double> travel;
  int taken = 0;
  if (std::sscanf(answer.c_str(), "%lf,%lf%n", &travel.first, &travel.second, &taken) != 2 ||
      taken != static_cast<int>(answer.size())) {
    throw InputError(fmt::format("\"{}\": a travel is two numbers, such as 0,500", answer));
  }
  if (!(travel.first < travel.second)) {
    throw InputError(fmt::format("\"{}\": give the lower end of the travel first", answer));
  }
  return travel;
}

// What `take` makes of an answer. A person at a terminal is asked again where it cannot be taken.
template <typename Take>
auto Asked(const Take& take) {
  for (;;) {
    try {
      return take();
    } catch (const InputError& failure) {
      if (isatty(STDIN_FILENO) == 0 || !std::cin) throw;
      fmt::print("{}\n", failure.what());
    }
  }
}

std::string KindAnswer() {
  const std::string kind = Answer("Kind of machine: mill, gantry, lathe, axis, arm, shaft", "mill");
  DescriptionOf(kind);
  return kind;
}

// "tool" or "carriage".
std::string PositiveAnswer() {
  const std::string answer = Answer(
      "Jog the table to a larger number: does the tool go towards the + end of the workpiece (tool), "
      "or the table towards + of the machine (carriage)?",
      "tool");
  if (answer == "tool" || answer == "carriage") return answer;
  throw InputError(fmt::format("\"{}\": answer tool or carriage", answer));
}

bool YesAnswer(const std::string& question) {
  const std::string answer = Answer(question + " (yes, no)", "no");
  if (answer == "yes" || answer == "y") return true;
  if (answer == "no" || answer == "n") return false;
  throw InputError(fmt::format("\"{}\": answer yes or no", answer));
}

void Ask(InitCommand& options, MachineDescription& machine) {
  machine.name = Answer("Name of the machine, as recordings will carry it", machine.name);
  bool carries = false;
  for (AxisDescription& axis : machine.axes) {
    axis.travel_mm = Asked([&] { return TravelAnswer(axis.letter, axis.travel_mm); });
    carries = carries || axis.carries_work;
  }
  if (carries) {
    options.positive = Asked(PositiveAnswer);
  }
  if (!machine.axes.empty()) {
    options.has_head =
        Asked([] { return YesAnswer("Will it be swept with the five-probe head?"); });
  }
}

// Those of the options; InputError for one of an axis that the machine does not have.
void TakeTravels(const InitCommand& options, MachineDescription& machine) {
  for (const char letter : std::string_view("XYZ")) {
    const std::vector<double>& given = options.travel_mm[letter - 'X'];
    if (given.empty()) continue;
    const auto axis = std::ranges::find(machine.axes, letter, &AxisDescription::letter);
    if (axis == machine.axes.end()) {
      throw InputError(
          fmt::format("--travel-{}: a machine of kind {} has no axis {}; leave it out, "
                      "or choose another --kind",
                      static_cast<char>(letter - 'A' + 'a'), machine.kind, letter));
    }
    axis->travel_mm = {given[0], given[1]};
  }
}

MachineDescription Described(InitCommand& options) {
  const bool may_ask = options.asks || (isatty(STDIN_FILENO) != 0 && isatty(STDOUT_FILENO) != 0);
  const bool asks = options.kind.empty() && options.ini.empty();
  if (asks && !may_ask) {
    throw InputError("--kind mill, gantry, lathe, axis, arm or shaft is missing");
  }
  if (asks) options.kind = Asked(KindAnswer);
  if (options.kind.empty()) options.kind = "mill";
  MachineDescription machine = DescriptionOf(options.kind);
  if (!options.ini.empty()) ReadLinuxcncIni(options.ini, machine);
  if (asks) Ask(options, machine);
  if (!options.name.empty()) machine.name = options.name;
  TakeTravels(options, machine);
  for (const AxisDescription& axis : machine.axes) {
    const bool stated =
        asks || !options.ini.empty() || !options.travel_mm[axis.letter - 'X'].empty();
    if (!stated) options.unstated.push_back(axis.letter);
  }
  if (!options.positive.empty()) machine.positive = options.positive;
  machine.has_head = options.has_head;
  return machine;
}

int Init(InitCommand& options) {
  if (!options.check.empty()) return CheckReadiness(options.check);
  if (!options.force && std::filesystem::exists(options.out)) {
    throw InputError(fmt::format("{}: is there already; name another file with --out, or --force",
                                 options.out.string()));
  }
  const MachineDescription machine = Described(options);
  const std::string text = MachineText(machine);
  ReadinessOf(settings::Document::Parse(text, options.out.string()));  // refused before written
  WriteText(text, options.out);
  const bool carries = std::any_of(machine.axes.begin(), machine.axes.end(),
                                   [](const AxisDescription& axis) { return axis.carries_work; });
  fmt::print("{}: written. Next:\n", options.out.string());
  if (!options.unstated.empty()) {
    fmt::print(
        "  write your travels: those of {} were not stated and are examples ([axis.X] "
        "travel_mm, or --travel-x FROM,TO)\n",
        fmt::join(options.unstated, ", "));
  }
  if (carries) {
    fmt::print("  look at the sense of the table's axes (positive = \"{}\"): the file says how\n",
               machine.positive);
  }
  fmt::print("  abbe init --check {}        what it lacks for which command\n",
             options.out.string());
  return kDone;
}

}  // namespace

void AddInit(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<InitCommand>();
  CLI::App* command = program.add_subcommand(
      "init", "Writes a commented machine file, from questions, options or a LinuxCNC INI file");
  command
      ->add_option("--kind", options->kind,
                   "mill (moving table), gantry, lathe, axis, arm, shaft; without it you are asked")
      ->check(CLI::IsMember(std::vector<std::string>(kMachineKinds.begin(), kMachineKinds.end())));
  command->add_option("--name", options->name,
                      "Name of the machine, in every recording and result");
  for (const char axis : {'x', 'y', 'z'}) {
    command
        ->add_option(
            fmt::format("--travel-{}", axis), options->travel_mm[axis - 'x'],
            fmt::format("Travel of {}, from,to in mm", static_cast<char>(axis - 'a' + 'A')))
        ->delimiter(',')
        ->expected(2);
  }
  command
      ->add_option(
          "--positive", options->positive,
          "Axes that carry the workpiece count as the tool goes (tool, ISO 841) or carriage")
      ->check(CLI::IsMember({"tool", "carriage"}));
  command->add_flag("--head", options->has_head,
                    "With the five-probe head, its sweeps and devices");
  command->add_option("--ini", options->ini, "LinuxCNC's INI file: name, travels, limits");
  command->add_flag("--ask", options->asks, "Ask even where no terminal is there");
  command->add_option("--check", options->check,
                      "Says what this machine file lacks, writes nothing");
  command->add_option("--out", options->out, "The machine file (machine.toml)");
  command->footer(
      "Example: abbe init --kind mill --name mill-7 --travel-x 0,800 --travel-y 0,500 --travel-z 0,500\n"
      "         abbe init --ini mill.ini --out mill.toml\n"
      "         abbe init --check mill.toml");
  command->callback([options, command, &exit_code] {
    options->force = command->count("--force") > 0;  // of output_guard.h
    exit_code = Init(*options);
  });
}

}  // namespace abbe::apps
