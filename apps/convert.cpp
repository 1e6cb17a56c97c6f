// abbe convert: recordings between the two file forms, and import of files of other programs.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/machine_file.h"
#include "hal/can/candump_recording.h"
#include "hal/can/canopen_device.h"
#include "recording/ballbar.h"
#include "recording/csv_table.h"
#include "recording/import.h"
#include "recording/monitor_log.h"
#include "recording/recording_file.h"
#include "recording/whole_file.h"

namespace abbe::apps {
namespace {

struct ConvertOptions {
  std::filesystem::path from;
  std::filesystem::path to;
  recording::ImportOptions import;
  std::vector<std::string> columns;  // NAME=CHANNEL
  std::vector<std::string> names;
  std::vector<double> sensor_degrees;
  std::vector<std::string> where;  // COLUMN=VALUE
  std::string kind;
  recording::BallbarCircle ballbar;
  std::string machine;
  std::string device;
  bool shuffled = false;
  bool quiet = false;
};

bool IsLog(const std::filesystem::path& path) { return path.extension() == ".log"; }

// The encoders of a log of CAN traffic.
hal::CanopenSettings EncodersOf(const MachineFile& file, const std::string& device) {
  const auto all = hal::SettingsOf<hal::CanopenDevice>(file.devices);
  if (device.empty() && all.size() == 1) return all.front();
  for (const hal::CanopenSettings& one : all) {
    if (one.name == device) return one;
  }
  throw InputError(fmt::format(
      "{}: {}", file.document.name(),
      all.empty() ? "has no device with transport = \"canopen\"; describe the encoders of the log"
      : device.empty() ? "has several devices on CAN; choose that of the log with --device"
                       : fmt::format("has no device \"{}\" on CAN; correct --device", device)));
}

MachineFile MachineOf(const ConvertOptions& options) {
  if (!options.machine.empty()) return ReadMachineFile(options.machine);
  throw InputError(options.from.string() +
                   ": a log of CAN traffic has counts without units; give the machine file "
                   "with --machine");
}

std::pair<std::string, std::string> SplitAt(const std::string& option, const std::string& text,
                                            const char* example) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InputError(fmt::format("{} {}: is not {}", option, text, example));
  }
  const auto trimmed = [](const std::string& part) {
    const auto first = part.find_first_not_of(' ');
    return first == std::string::npos ? std::string()
                                      : part.substr(first, part.find_last_not_of(' ') + 1 - first);
  };
  return {trimmed(text.substr(0, equals)), trimmed(text.substr(equals + 1))};
}

std::vector<recording::MonitoredColumn> ColumnsOf(const ConvertOptions& options) {
  std::vector<recording::MonitoredColumn> columns;
  for (const std::string& text : options.columns) {
    auto [name, channel] =
        SplitAt("--column", text, "NAME=CHANNEL, for example shaft_deg=TARGET:Rotation-PosAct");
    columns.push_back({std::move(name), std::move(channel)});
  }
  return columns;
}

recording::Recording ReadTable(const ConvertOptions& options) {
  if (!options.import.axis.empty() || options.import.u_probing_um > 0.0) {
    throw InputError(
        options.from.string() +
        ": --axis and --probing-um are for files of other programs (.dat, .rtl, .txt); "
        "leave them out, and name the columns of this table with --column");
  }
  recording::CsvTableOptions table{
      ColumnsOf(options), {}, options.kind, options.names, options.shuffled};
  for (const std::string& text : options.where) {
    table.where.push_back(SplitAt("--where", text, "COLUMN=VALUE, for example arm=2"));
  }
  const recording::Recording read = recording::ReadCsvTable(options.from, table);
  return options.ballbar.radius_mm > 0.0 ? recording::BallbarOf(read, options.ballbar) : read;
}

recording::Recording ReadAny(const ConvertOptions& options) {
  if (IsLog(options.from) && recording::IsMonitorLog(options.from)) {
    return recording::ReadMonitorLog(options.from, ColumnsOf(options), options.sensor_degrees);
  }
  if (IsLog(options.from)) {
    const MachineFile file = MachineOf(options);
    return hal::RecordingOf(hal::ReadCandump(options.from), EncodersOf(file, options.device),
                            file.devices.stale, file.sweep_setup.machine.name);
  }
  if (recording::IsCsvTable(options.from)) return ReadTable(options);
  const auto imported = recording::Import(options.from, options.import);
  return imported ? *imported : recording::Read(options.from);
}

void WriteAny(const recording::Recording& recording, const ConvertOptions& options) {
  if (!IsLog(options.to)) return recording::Write(recording, options.to);
  const MachineFile file = MachineOf(options);
  hal::WriteCandump(hal::LogOf(recording, EncodersOf(file, options.device)), options.to);
}

int Convert(const ConvertOptions& options) {
  if (std::filesystem::is_regular_file(options.to) && !recording::OverwritingIsForced()) {
    throw InputError(
        fmt::format("{}: exists already, and nothing recorded is overwritten; choose another name, "
                    "or add --force",
                    options.to.string()));
  }
  const recording::Recording recording = ReadAny(options);
  WriteAny(recording, options);
  for (const std::string& warning : recording.warnings) fmt::print(stderr, "abbe: {}\n", warning);
  if (!options.quiet) {
    fmt::print("{}: {}, {} rows, {} columns\n", options.to.string(), recording.Kind(),
               recording.rows(), recording.columns.size());
  }
  return kDone;
}

}  // namespace

void AddConvert(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<ConvertOptions>();
  CLI::App* command = program.add_subcommand(
      "convert",
      "A recording from CSV to HDF5 or back, from a table or a log, or to a log of candump");
  command
      ->add_option("from", options->from,
                   "A recording (.csv, .h5, .hdf5), a table (.dat, .rtl, .txt, .csv), a log (.log)")
      ->required();
  command->add_option("to", options->to, "The new recording (.csv, .h5, .hdf5), or log (.log)")
      ->required();
  command->add_option("--machine", options->machine, "Logs: the machine file with the encoders");
  command->add_option("--device", options->device, "Logs: the device, if there are several on CAN");
  command
      ->add_option("--column", options->columns,
                   "Logs of a monitor, tables in CSV: NAME=CHANNEL, the name with its unit; may be "
                   "repeated. For a table also a sum, deg=counts*0.00549+3 or z_mm=a+b")
      ->allow_extra_args(false);
  command
      ->add_option("--columns", options->names,
                   "Tables in CSV without a line of names: the names of all columns, with commas "
                   "between; - leaves one out")
      ->delimiter(',');
  command
      ->add_option(
          "--sensor-deg", options->sensor_degrees,
          "Logs of a monitor at a turning shaft: the angles of gap_1, gap_2, ... round it, "
          "with commas between")
      ->delimiter(',');
  command
      ->add_option("--where", options->where,
                   "Tables in CSV: COLUMN=VALUE, only rows with this value; may be repeated")
      ->allow_extra_args(false);
  command->add_flag("--shuffled", options->shuffled,
                    "Tables in CSV: the rows are in no order of measurement, and none is recorded "
                    "(an index column is given by --column order=NAME)");
  command
      ->add_option("--ballbar-mm", options->ballbar.radius_mm,
                   "Tables in CSV with angle_deg and deviation_um: the programmed radius of a "
                   "ballbar's circle")
      ->check(PositiveNumber());
  command->add_option("--plane", options->ballbar.plane, "Ballbars: the plane, XY, YZ or ZX (XY)")
      ->check(CLI::IsMember({"XY", "YZ", "ZX"}));
  command
      ->add_option("--feed-mm-min", options->ballbar.feed_mm_min, "Ballbars: the programmed feed")
      ->check(PositiveNumber());
  command
      ->add_option("--centre-mm", options->ballbar.centre_mm,
                   "Ballbars: X,Y,Z of the axes with the tool at the centre ball; needed for a map "
                   "and a diagnosis")
      ->delimiter(',')
      ->expected(3);
  command->add_option("--ballbar", options->ballbar.ballbar,
                      "Ballbars: its name; circles of one bar share its length");
  command
      ->add_option("--u-length-um", options->ballbar.u_length_um,
                   "Ballbars: standard uncertainty of its length, where that was calibrated and "
                   "radii are true lengths")
      ->check(PositiveNumber());
  command->add_option("--kind", options->kind, "Tables in CSV: the kind of the recording (linkage)")
      ->default_val("linkage");
  command
      ->add_option("--axis", options->import.axis, "The axis of a table that does not name it (X)")
      ->check(CLI::IsMember({"X", "Y", "Z"}));
  command
      ->add_option("--probing-um", options->import.u_probing_um,
                   "Standard uncertainty of a hole centre in a table of holes")
      ->check(PositiveNumber());
  command->add_flag("--quiet", options->quiet, "Print nothing but warnings");
  command->footer(
      "Example: abbe convert sweep_X.csv sweep_X.h5\n"
      "         abbe convert poses.csv arm.csv --column pivot_1_rad=S --column ref_x_mm=x_m "
      "--where "
      "arm=2");
  command->callback([options, &exit_code] { exit_code = Convert(*options); });
}

}  // namespace abbe::apps
