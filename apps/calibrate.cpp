// abbe calibrate: the parameters of the linkage from its recordings, or the plan of a calibration.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/calibrate_arm.h"
#include "apps/calibration_tables.h"
#include "apps/causes_option.h"
#include "apps/command.h"
#include "apps/commands.h"
#include "apps/error_model_option.h"
#include "apps/instruments.h"
#include "apps/machine_file.h"
#include "apps/machine_recording.h"
#include "apps/protocol.h"
#include "apps/result_file.h"
#include "apps/working_line.h"
#include "fusion/calibration_file.h"
#include "fusion/doubted_calibration.h"
#include "recording/recording_file.h"
#include "simulation/arm/arm_run.h"
#include "simulation/linkage/one_ball.h"

namespace abbe::apps {
namespace {

namespace fs = std::filesystem;
using Eigen::Index;

struct CalibrateArguments {
  std::vector<fs::path> recordings, checks;
  fs::path machine, out, json;
  CausesOption causes;
  std::optional<relm::ErrorModel> model;
  std::vector<double> volume_mm;
  bool displacement = false, mapped = false, compare = false, study = false, quiet = false;
  int poses = 0;
  int folds = 5;
};

constexpr std::array<Index, 10> kCounts{6, 8, 12, 16, 24, 32, 48, 64, 96, 128};
const Eigen::Vector3i kCubePoints(7, 7, 12);  // the cube of Boelens (2006)
constexpr int kPlanPoints = 9;                // along each side of the travel, to choose from

class Calibration {
 public:
  explicit Calibration(const CalibrateArguments& arguments)
      : arguments_(arguments),
        file_(ReadMachineFile(arguments.machine)),
        causes_(arguments.causes, file_, kForCalibrating) {
    if (!file_.linkage) {
      throw InputError(fmt::format("{}: has no table [linkage]; describe the linkage there",
                                   arguments.machine.string()));
    }
    options_.model = arguments.model.value_or(
        arguments.mapped ? relm::ErrorModel::kPublishedWithBearing : relm::ErrorModel::kComplete);
    options_.problem.displacement = arguments.displacement;
    options_.mapped = arguments.mapped;
    options_.folds = arguments.folds;
  }

  int Run() {
    if (arguments_.study) {
      Show(VolumeTable(fusion::StudyVolumes(Simulation(), Travel())));
    } else if (!arguments_.volume_mm.empty()) {
      WhatIsSeen();
    } else if (!arguments_.recordings.empty() && arguments_.compare) {
      Compare();
    } else if (!arguments_.recordings.empty()) {
      FromRecordings();
    } else if (arguments_.poses > 0) {
      Plan();
    } else {
      throw InputError(
          "nothing to calibrate with; name recordings of kind linkage, or ask for a plan with "
          "--poses N, --study or --volume X,Y,Z");
    }
    if (causes_.Active()) Show(causes_.Line() + "\n");
    return kDone;
  }

 private:
  simulation::LinkageRun Read(const fs::path& path) {
    const recording::Recording recording = ReadWithWarnings(path);
    return simulation::ReadLinkageRun(causes_.Take(recording), *file_.linkage);
  }

  void Compare() {
    if (arguments_.recordings.size() != 1) {
      throw InputError(
          fmt::format("--compare takes one recording, {} given; name others by --check",
                      arguments_.recordings.size()));
    }
    std::vector<simulation::LinkageRun> checks;
    for (const fs::path& path : arguments_.checks) checks.push_back(Read(path));
    const auto rows = fusion::CompareModels(
        file_.sweep_setup.machine.chain, *file_.linkage,
        simulation::MeansOfStays(Read(arguments_.recordings.front())), checks, options_);
    Show(ComparisonTable(rows));
    if (!arguments_.json.empty()) {
      WriteResult({{"kind", "calibration comparison"}, {"models", ComparisonJson(rows)}},
                  arguments_.json);
    }
  }

  void FromRecordings() {
    RefuseTwice(arguments_.recordings);
    std::vector<simulation::LinkageRun> runs, certain;
    simulation::OneBall ball("give recordings of one ball at a time");
    nlohmann::ordered_json whose = nlohmann::ordered_json::object();
    for (const fs::path& path : arguments_.recordings) {
      const recording::Recording recording = ReadWithWarnings(path);
      const auto means = [&](const recording::Recording& corrected) {
        return simulation::MeansOfStays(simulation::ReadLinkageRun(corrected, *file_.linkage));
      };
      runs.push_back(means(causes_.Take(recording)));
      if (causes_.WidensU95()) certain.push_back(means(causes_.TakeCertain(recording)));
      ball.Add(recording, runs.back());
      AddProtocol(recording, whose);
    }
    RefuseNearCopies(arguments_.recordings);
    if (arguments_.poses > 0) KeepBest(runs, certain);
    fusion::CalibrationReport report = CalibrationOf(runs);
    if (causes_.WidensU95()) {
      fusion::AddDoubt(CalibrationOf(certain), causes_.unexplained(), runs, *file_.linkage, report);
    }
    report.calibration.machine = file_.sweep_setup.machine.name;
    Show(CalibrationTable(report, runs));
    if (!arguments_.out.empty()) fusion::WriteCalibration(report.calibration, arguments_.out);
    auto json = CalibrationJson(report, runs);
    json.update(whose);
    if (causes_.Active()) json["causes_taken_out"] = causes_.Data();
    if (!arguments_.json.empty()) WriteResult(json, arguments_.json);
  }

  fusion::CalibrationReport CalibrationOf(const std::vector<simulation::LinkageRun>& runs) const {
    const WorkingLine line("calibrate", arguments_.quiet);
    return fusion::Calibrate(file_.sweep_setup.machine.chain, *file_.linkage, runs, options_);
  }

  // Plans poses in a box, before anything is measured.
  void WhatIsSeen() {
    const auto simulation = Simulation();
    const Eigen::Vector3d mm(arguments_.volume_mm.data());
    auto run = simulation::RunAt(fusion::GridIn(Travel(), 1e-3 * mm, kCubePoints), *file_.linkage);
    run.readings.angles = simulation.Readings(run, simulation.Values());
    const auto problem = simulation::MakeLinkageProblem(simulation, {run}, options_.problem);
    const auto seen = fusion::Observe(problem, simulation::SolveLinkage(problem));
    Show(fmt::format("{} poses in {:g} x {:g} x {:g} mm, model \"{}\".\n", run.poses(), mm.x(),
                     mm.y(), mm.z(), relm::ErrorModelName(options_.model)));
    Show(SeenTable(seen));
  }

  // Chooses the poses of one recording that give the best calibration; `others` keep the same.
  void KeepBest(std::vector<simulation::LinkageRun>& runs,
                std::vector<simulation::LinkageRun>& others) {
    if (runs.size() != 1) {
      throw InputError(fmt::format("--poses chooses from one recording, {} given", runs.size()));
    }
    const auto simulation = Simulation();
    auto chosen = Choose(fusion::PoseInformation(simulation, runs[0], simulation.Values()));
    std::sort(chosen.begin(), chosen.end());  // in order of time again, for the held-out blocks
    for (auto* of : {&runs, &others}) {
      for (simulation::LinkageRun& run : *of) run = simulation::Selection(run, chosen);
    }
  }

  void Plan() {
    const auto simulation = Simulation();
    const auto travel = Travel();
    auto run = simulation::RunAt(
        fusion::GridIn(travel, travel.last - travel.first, Eigen::Vector3i::Constant(kPlanPoints)),
        *file_.linkage);
    run.readings.angles = simulation.Readings(run, simulation.Values());
    const auto chosen = Choose(fusion::PoseInformation(simulation, run, simulation.Values()));
    std::string csv = "x_mm,y_mm,z_mm\n";
    for (const Index pose : chosen) {
      const Eigen::Vector3d mm = 1e3 * run.commanded.col(pose);
      csv += fmt::format("{:.4f},{:.4f},{:.4f}\n", mm.x(), mm.y(), mm.z());
    }
    if (arguments_.out.empty()) {
      Show(csv);
    } else {
      WriteText(csv, arguments_.out);
    }
  }

  std::vector<Index> Choose(const fusion::PoseInformation& candidates) {
    const auto choice = fusion::ChoosePoses(candidates, arguments_.poses);
    Show(EnoughTable(fusion::HowManyPoses(candidates, {kCounts.begin(), kCounts.end()}),
                     candidates.reading_noise));
    Show(fmt::format("The {} chosen poses leave {:.3f} um.\n\n", arguments_.poses,
                     1e6 * choice.tip_rms));
    return choice.poses;
  }

  simulation::LinkageSimulation Simulation() const {
    return {file_.sweep_setup.machine.chain, *file_.linkage,
            relm::MakeLinkageModel(*file_.linkage, options_.model)};
  }

  fusion::Travel Travel() const {
    fusion::Travel travel;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      travel.first[axis] = file_.sweep_setup.machine.travels[axis].first;
      travel.last[axis] = file_.sweep_setup.machine.travels[axis].last;
    }
    return travel;
  }

  void Show(const std::string& text) const {
    if (!arguments_.quiet) fmt::print("{}", text);
  }

  const CalibrateArguments& arguments_;
  MachineFile file_;
  CauseCorrection causes_;
  fusion::CalibrateOptions options_;
};

// Whether the first recording is of an arm, which no machine carries.
bool IsOfArm(const CalibrateArguments& arguments) {
  return !arguments.recordings.empty() &&
         simulation::IsArm(recording::ReadHead(arguments.recordings.front())) &&
         !ReadInstruments(arguments.machine).HasAxes();
}

ArmArguments OfArm(const CalibrateArguments& a) {
  if (a.displacement || a.mapped || a.compare || a.study || a.poses > 0 || a.model ||
      !a.volume_mm.empty()) {
    throw InputError(fmt::format(
        "{}: is of an arm, whose rows or axes are fitted as they are: --model, --displacement, "
        "--mapped, --compare, --poses, --volume and --study are for a linkage on a machine; leave "
        "them out",
        a.recordings.front().string()));
  }
  return {a.recordings, a.checks, a.machine, a.out, a.json, a.causes, a.quiet};
}

}  // namespace

void AddCalibrate(CLI::App& program, int& exit_code) {
  auto arguments = std::make_shared<CalibrateArguments>();
  CLI::App* command =
      program.add_subcommand("calibrate", "The linkage's parameters, and what the data cannot see");
  command->add_option("recordings", arguments->recordings,
                      "Recordings of kind linkage or reference");
  command->add_option("--machine", arguments->machine, "Machine file")->required();
  AddErrorModelOption(*command, arguments->model);
  AddCausesOption(*command, arguments->causes);
  command->add_flag("--displacement", arguments->displacement,
                    "Nothing is known of the base position");
  command->add_flag("--mapped", arguments->mapped, "Local parameters on the grid of the poses");
  command->add_flag("--compare", arguments->compare,
                    "All models side by side, mapped and not, instead of a calibration");
  command
      ->add_option(
          "--check", arguments->checks,
          "A recording that takes no part: with --compare, such as a circle; of an arm, the "
          "poses to test with; repeatable")
      ->allow_extra_args(false);
  command
      ->add_option("--poses", arguments->poses,
                   "Use the best N poses; without recordings: plan them")
      ->check(PositiveNumber());
  command
      ->add_option("--volume", arguments->volume_mm,
                   "X,Y,Z in mm: what poses in such a box would see of the parameters, in words")
      ->delimiter(',')
      ->expected(3)
      ->check(PositiveNumber());
  command->add_flag("--study", arguments->study, "Which calibration volume and spacing");
  command->add_option("--folds", arguments->folds, "Blocks held out in turn; 1: none")
      ->check(CLI::Range(1, 100));
  command->add_option("-o,--out", arguments->out,
                      "Calibration file (TOML); of an arm: the new machine file; for a plan: CSV");
  command->add_option("--json", arguments->json, "File for the result as data");
  command->add_flag("--quiet", arguments->quiet, "No tables");
  command->footer(
      "Example: abbe calibrate cube.csv --machine mill.toml -o linkage.toml\n"
      "         abbe calibrate poses.csv --check test.csv --machine arm.toml -o arm_now.toml");
  command->callback([arguments, &exit_code] {
    exit_code =
        IsOfArm(*arguments) ? CalibrateArm(OfArm(*arguments)) : Calibration(*arguments).Run();
  });
}

}  // namespace abbe::apps
