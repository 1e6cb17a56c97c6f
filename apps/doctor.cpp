// `abbe doctor`: whether this computer and the devices of a machine are ready to measure.
#include <fmt/format.h>
#include <sys/timex.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/machine_file.h"
#include "apps/plausible_channels.h"
#include "failure/failure.h"
#include "hal/clock.h"

namespace abbe::apps {
namespace {

struct DoctorCommand {
  std::filesystem::path machine, out = ".";
  int readings = 50;
};

// Counts and prints what is found.
class Findings {
 public:
  void Good(const std::string& text) { fmt::print("good     {}\n", text); }
  void Doubtful(const std::string& text) { fmt::print("doubtful {}\n", text); }
  void Bad(const std::string& text, int exit_code) {
    fmt::print("bad      {}\n", text);
    if (exit_code_ == kDone) exit_code_ = exit_code;
  }
  int exit_code() const { return exit_code_; }

 private:
  int exit_code_ = kDone;
};

void LookAtClock(Findings& findings) {
  using std::chrono::system_clock;
  const auto year =
      std::chrono::year_month_day(std::chrono::floor<std::chrono::days>(system_clock::now()))
          .year();
  constexpr int kFirstYear = 2024;
  if (static_cast<int>(year) < kFirstYear) {
    findings.Bad(
        fmt::format("clock: it is the year {}; set the date, or recordings are dated wrong",
                    static_cast<int>(year)),
        kRequirementNotMet);
    return;
  }
  timex state{};
  const bool is_unset = adjtimex(&state) == TIME_ERROR || (state.status & STA_UNSYNC) != 0;
  if (is_unset) {
    findings.Doubtful("clock: not kept by a time server; instants of two computers may disagree");
  } else {
    findings.Good("clock: kept by a time server");
  }
}

// A row of a recording as text takes about this much a channel.
constexpr double kBytesAChannel = 12.0;

void LookAtDisk(Findings& findings, const std::filesystem::path& folder, double bytes_a_second) {
  std::error_code error;
  const auto space = std::filesystem::space(folder, error);
  if (error) {
    findings.Bad(fmt::format("disk: {}: {}; make the folder", folder.string(), error.message()),
                 kRequirementNotMet);
    return;
  }
  const double free_gb = static_cast<double>(space.available) * 1e-9;
  constexpr double kSecondsAnHour = 3600.0, kFewestHours = 8.0, kFewestGb = 1.0;
  if (bytes_a_second == 0.0) {
    const std::string text = fmt::format("disk: {:.3g} GB free in {}", free_gb, folder.string());
    free_gb < kFewestGb ? findings.Doubtful(text + "; a day of recordings may take more")
                        : findings.Good(text);
    return;
  }
  const double hours = free_gb * 1e9 / bytes_a_second / kSecondsAnHour;
  const std::string text = fmt::format("disk: {:.3g} GB free in {}: {:.3g} h of this machine",
                                       free_gb, folder.string(), hours);
  hours < kFewestHours ? findings.Doubtful(text) : findings.Good(text);
}

// Opens the devices and takes some readings; the rate of data, bytes a second.
double LookAtDevices(Findings& findings, const MachineFile& file, int readings) {
  hal::SteadyClock clock;
  try {
    PlausibleDevices opened = OpenPlausible(file, file.devices, readings, clock);
    const std::size_t channels = opened.source->channels().size();
    findings.Good(
        fmt::format("devices: all {} answer, {} channels", file.devices.devices.size(), channels));
    for (const std::string& warning : opened.warnings) findings.Doubtful("readings: " + warning);
    if (opened.warnings.empty()) findings.Good("readings: gaps and positions are plausible");
    return kBytesAChannel * static_cast<double>(channels) * file.devices.rate;
  } catch (const DeviceError& failure) {
    findings.Bad(fmt::format("devices: {}", failure.what()), kDeviceFailed);
    return 0.0;
  }
}

int Doctor(const DoctorCommand& options) {
  Findings findings;
  LookAtClock(findings);
  double bytes_a_second = 0.0;
  if (!options.machine.empty()) {
    const MachineFile file = ReadMachineFile(options.machine);
    findings.Good(fmt::format("machine file: {} is {}", options.machine.string(),
                              file.sweep_setup.machine.name));
    if (file.devices.devices.empty()) {
      findings.Doubtful("devices: the machine file names none (docs/devices.md)");
    } else {
      bytes_a_second = LookAtDevices(findings, file, options.readings);
    }
  }
  LookAtDisk(findings, options.out, bytes_a_second);
  return findings.exit_code();
}

}  // namespace

void AddDoctor(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<DoctorCommand>();
  CLI::App* command = program.add_subcommand(
      "doctor", "Looks at devices, readings, clock and disk before a measurement");
  command->add_option("--machine", options->machine, "Machine file with the devices to look at");
  command->add_option("--out", options->out, "Folder of the recordings to come (.)");
  command->add_option("--readings", options->readings, "Readings to look at (50)")
      ->check(CLI::Range(1, 100'000));
  command->footer("Example: abbe doctor --machine mill.toml --out measured");
  command->callback([options, &exit_code] { exit_code = Doctor(*options); });
}

}  // namespace abbe::apps
