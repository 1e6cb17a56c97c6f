// abbe path: tests on paths other than circles, by the linkage or a reference.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/measured_paths.h"
#include "apps/path_result.h"
#include "apps/path_uncertainty.h"
#include "apps/result_file.h"
#include "paths/nominal_path.h"
#include "recording/recording_file.h"
#include "settings/unit.h"

namespace abbe::apps {
namespace {

struct PathCommand {
  PathSources sources;
  std::string test;
  std::vector<std::string> gauges;  // "X=probe_d_um", "Y=-probe_e_um"
  std::filesystem::path json, out;
  bool quiet = false;
};

std::vector<paths::CapGauge> Gauges(const PathCommand& command) {
  std::vector<paths::CapGauge> gauges;
  for (const std::string& text : command.gauges) {
    if (text.size() < 3 || text[1] != '=' || text[0] < 'X' || text[0] > 'Z') {
      throw InputError(fmt::format(
          "--gauge {}: give the axis and the column that increases along it, for example "
          "--gauge X=probe_d_um, or --gauge X=-probe_d_um for one that decreases",
          text));
    }
    const bool falls = text[2] == '-';
    gauges.push_back({text[0], falls ? -1.0 : 1.0, text.substr(falls ? 3 : 2)});
  }
  return gauges;
}

constexpr double kOneSeat = 1e-3;  // m

void RefuseMotion(const paths::MeasuredPath& path) {
  const Eigen::Vector3d moved =
      path.commanded.rowwise().maxCoeff() - path.commanded.rowwise().minCoeff();
  if (moved.maxCoeff() < kOneSeat) return;
  throw InputError(fmt::format(
      "{}: the commanded position moves by {:.3g} mm: single-point articulation keeps the ball in "
      "one seat while the linkage takes many poses, one pass each",
      path.recording, moved.maxCoeff() / settings::kMillimetre));
}

// One pose per pass, the mean of its rows; with a single pass one pose per row.
Eigen::Matrix3Xd Poses(const paths::MeasuredPath& path) {
  std::map<int, std::vector<Eigen::Index>> passes;
  for (Eigen::Index i = 0; i < path.poses(); ++i) passes[path.pass[i]].push_back(i);
  if (passes.size() < 2) return path.measured;
  Eigen::Matrix3Xd poses(3, passes.size());
  Eigen::Index pose = 0;
  for (const auto& [pass, rows] : passes) {
    poses.col(pose++) = paths::Selection(path, rows).measured.rowwise().mean();
  }
  return poses;
}

TestResult Deviation(const paths::MeasuredPath& path, const Eigen::Matrix3Xd& nominal) {
  return DeviationResult(paths::DeviationFrom(path, {nominal, false}),
                         paths::DeviationFrom(path, {nominal, true}));
}

// The figures of a test and, if the path is followed, its deviation in space.
TestResult Evaluate(const PathCommand& command, const paths::MeasuredPath& path) {
  if (command.test == "articulation") {
    RefuseMotion(path);
    return ArticulationResult(standards::EvaluateArticulation(Poses(path)));
  }
  if (command.test == "stepping") return SteppingResult(paths::EvaluateStepping(path));
  if (command.test != "square") return Deviation(path, paths::ReadNominalPath(command.test));
  TestResult square = SquareResult(paths::EvaluateSquare(path));
  const TestResult deviation = Deviation(path, {});
  square.table += deviation.table;
  square.data.update(deviation.data);
  return square;
}

LeftUnexplained LeftIn(const paths::MeasuredPath& path, double unexplained) {
  const Eigen::Vector3d extent =
      path.commanded.rowwise().maxCoeff() - path.commanded.rowwise().minCoeff();
  return {unexplained, extent.maxCoeff() > 0.0 ? unexplained / extent.maxCoeff() : 0.0};
}

bool IsNamed(const std::string& test) {
  return test == "stepping" || test == "square" || test == "cap" || test == "articulation";
}

class PathTests {
 public:
  explicit PathTests(const PathCommand& command) : command_(command) {}

  int Run() {
    if (command_.test == "cap") {
      Cap();
    } else {
      const MeasuredPaths paths = ReadMeasuredPaths(command_.sources);
      result_ = ResultHead("path", paths);
      result_["kind"] = IsNamed(command_.test) ? command_.test : "path";
      if (!IsNamed(command_.test)) {
        result_["nominal"] = std::filesystem::path(command_.test).filename().string();
      }
      const std::vector<paths::MeasuredPath> all = paths.All();
      std::vector<std::vector<TestResult>> shifted(all.size());
      for (std::size_t error = 0; error < paths.errors.size(); ++error) {
        const std::vector<paths::MeasuredPath> moved = paths.WithError(error);
        for (std::size_t i = 0; i < paths.linkage.size(); ++i) {
          shifted[i].push_back(Evaluate(command_, moved[i]));
        }
      }
      for (const paths::MeasuredPath& path : all) {
        if (path.instrument != paths::kByBallbar) continue;
        throw InputError(path.recording +
                         ": a ballbar knows radii only; abbe circle evaluates its circle");
      }
      for (std::size_t i = 0; i < all.size(); ++i) {
        TestResult test = Evaluate(command_, all[i]);
        AddCalibrationUncertainty(shifted[i], LeftIn(all[i], paths.unexplained), test);
        Keep(all[i].recording, all[i].instrument, test);
      }
      Note(paths.notes);
    }
    if (!command_.json.empty()) WriteResult(result_, command_.json);
    if (!command_.out.empty()) {
      const std::string stem = command_.sources.recordings.front().stem().string();
      WriteResult(result_, command_.out /
                               fmt::format("{}_{}.json", stem, result_["kind"].get<std::string>()));
    }
    return kDone;
  }

 private:
  // Measured by gauges or a reference; with a calibration, by the linkage relative to the
  // reference.
  void Cap() {
    const bool linkage = !command_.sources.calibration.empty();
    const MeasuredPaths paths = linkage ? ReadMeasuredPaths(command_.sources) : MeasuredPaths{};
    result_ = ResultHead("path", paths);
    result_["kind"] = "cap";
    const std::vector<paths::CapGauge> gauges = Gauges(command_);
    for (const std::filesystem::path& file : command_.sources.recordings) {
      const recording::Recording recording = recording::Read(file);
      if (!result_.contains("machine")) {
        result_["machine"] = recording.HeaderText("machine").value_or("");
      }
      const auto ball =
          std::ranges::find(paths.linkage, recording.name, &paths::MeasuredPath::recording);
      if (gauges.empty() && ball != paths.linkage.end()) {
        Keep(recording.name, "linkage - reference",
             CapResult(paths::EvaluateCap(recording, *ball)));
      } else {
        Keep(recording.name, gauges.empty() ? "reference" : "gauges",
             CapResult(paths::EvaluateCap(recording, gauges)));
      }
    }
    Note(paths.notes);
  }

  void Keep(const std::string& recording, const std::string& instrument, const TestResult& test) {
    const std::string name = std::filesystem::path(recording).filename().string();
    if (!command_.quiet) fmt::print("{}, {}\n{}", name, instrument, test.table);
    nlohmann::ordered_json entry{{"recording", name}, {"instrument", instrument}};
    entry.update(test.data);
    result_["tests"].push_back(std::move(entry));
  }

  void Note(const std::vector<std::string>& notes) {
    result_["notes"] = notes;
    if (command_.quiet) return;
    for (const std::string& note : notes) fmt::print("note: {}\n", note);
  }

  const PathCommand& command_;
  nlohmann::ordered_json result_;
};

}  // namespace

void AddPath(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<PathCommand>();
  CLI::App* command = program.add_subcommand(
      "path", "Stepping test, square path, tool cap, articulation, or any path");
  AddPathSources(*command, options->sources);
  command
      ->add_option("--test", options->test,
                   "stepping, square, cap, articulation, or a CSV file with the nominal path "
                   "(x_mm,y_mm,z_mm)")
      ->required();
  command->add_option("--gauge", options->gauges,
                      "cap: axis and column of a gauge on the cap, X=probe_d_um (default: the "
                      "reference columns; with --calibration the linkage relative to them)");
  command->add_option("-o,--out", options->out, "Folder for the result (RECORDING_TEST.json)");
  command->add_option("--json", options->json, "File for the result");
  command->add_flag("--quiet", options->quiet, "No table");
  command->footer("Example: abbe path square.csv --test square --machine mill.toml --out measured");
  command->callback([options, &exit_code] { exit_code = PathTests(*options).Run(); });
}

}  // namespace abbe::apps
