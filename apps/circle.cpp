// abbe circle: the circular test, by the linkage, a reference instrument, or both side by side.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/circle_result.h"
#include "apps/command.h"
#include "apps/commands.h"
#include "apps/measured_paths.h"
#include "apps/result_file.h"
#include "settings/unit.h"
#include "simulation/doubt.h"

namespace abbe::apps {
namespace {

struct CircleCommand {
  PathSources sources;
  std::string plane;
  double radius_mm = 0.0, filter = 0.0, spike_deg = 4.0, limit_um = 0.0;
  std::vector<std::string> pitches;  // "X=5", mm
  std::filesystem::path json, out;
  bool quiet = false;
};

constexpr double kNotCalibrated = 1e-3;  // m: of the length of a ballbar
constexpr double kSameRadius = 0.01;     // of the radius: lag reduces a fast circle

fusion::CauseOptions CausesOf(const CircleCommand& command) {
  fusion::CauseOptions options;
  options.spike_width = command.spike_deg * 0.017453292519943295;
  for (const std::string& text : command.pitches) {
    double pitch = 0.0;
    const bool named = text.size() > 2 && text[1] == '=' && text[0] >= 'X' && text[0] <= 'Z';
    const char* const end = text.data() + text.size();
    if (!named || std::from_chars(text.data() + 2, end, pitch).ptr != end || !(pitch > 0.0)) {
      throw InputError(fmt::format(
          "--pitch {}: give an axis and its pitch in mm above 0, for example --pitch X=5", text));
    }
    options.pitch[text[0]] = pitch * settings::kMillimetre;
  }
  return options;
}

using Runs = std::vector<paths::CircleRun>;

// Groups the runs by instrument, plane and radius; the linkage first.
std::vector<Runs> Grouped(Runs&& all) {
  std::vector<Runs> groups;
  for (paths::CircleRun& run : all) {
    const auto same = std::ranges::find_if(groups, [&run](const Runs& group) {
      const paths::CircleRun& one = group.front();
      return one.instrument == run.instrument && one.plane.name == run.plane.name &&
             std::abs(one.radius - run.radius) < kSameRadius * run.radius && !run.plane.Inclined();
    });
    (same == groups.end() ? groups.emplace_back() : *same).push_back(std::move(run));
  }
  return groups;
}

// What is unexplained beside an extended model may be on the radius as it is.
void AddUnexplained(double unexplained, Circle& circle) {
  for (FigureUncertainties& figures : circle.uncertainties) {
    for (FigureUncertainty& u : figures) {
      u.calibration = simulation::WithDoubt(u.calibration, 0.0, unexplained);
    }
  }
  if (!circle.causes) return;
  for (fusion::CauseEstimate& one : circle.causes->causes) {
    if (!(one.effect > 0.0)) continue;
    const double per_metre = std::abs(one.value) / one.effect;
    one.u = simulation::WithDoubt(one.u, 0.0, unexplained * per_metre);
  }
}

// Evaluates the runs of one circle. `shifted`: the runs with each error of the calibration.
Circle Evaluate(Runs runs, const std::vector<const Runs*>& shifted, const MeasuredPaths& paths,
                const CircleCommand& command) {
  Circle circle{std::move(runs), {}, {}, {}, command.filter};
  fusion::CauseOptions options = CausesOf(command);
  if (paths.machine) {
    options.smooth = fusion::SmoothHarmonics(*paths.machine, circle.runs.front());
  }
  for (const Runs* one : shifted) {
    options.shifted.emplace_back();
    for (const paths::CircleRun& run : *one) options.shifted.back().push_back(&run);
  }
  std::vector<const paths::CircleRun*> all;
  all.reserve(circle.runs.size());
  for (std::size_t i = 0; i < circle.runs.size(); ++i) {
    const paths::CircleRun& run = circle.runs[i];
    std::vector<const paths::CircleRun*> others;
    others.reserve(shifted.size());
    for (const Runs* one : shifted) others.push_back(&(*one)[i]);
    circle.figures.push_back(paths::EvaluateCircle(run, {.cutoff = command.filter}));
    circle.uncertainties.push_back(
        UncertaintiesOf(run, others, circle.figures.back(), {.cutoff = command.filter}));
    all.push_back(&run);
  }
  if (!all.front()->plane.Inclined()) circle.causes = fusion::FitCircleCauses(all, options);
  if (circle.runs.front().instrument == paths::kByLinkage && paths.unexplained > 0.0) {
    AddUnexplained(paths.unexplained, circle);
  }
  return circle;
}

// The runs by a ballbar that is longer by one standard deviation.
Runs LongerBar(Runs runs) {
  for (paths::CircleRun& run : runs) {
    const double times = 1.0 + run.u_length.value_or(kNotCalibrated) / run.radius;
    for (paths::CirclePoint& point : run.points) {
      point.first *= times;
      point.second *= times;
    }
  }
  return runs;
}

std::vector<Circle> Circles(const MeasuredPaths& paths, const CircleCommand& command) {
  const paths::CircleOptions options{command.plane, command.radius_mm * settings::kMillimetre};
  std::vector<std::vector<Runs>> shifted;
  for (std::size_t error = 0; error < paths.errors.size(); ++error) {
    shifted.push_back(Grouped(paths::CircleRuns(paths.WithError(error), options)));
  }
  std::vector<Circle> circles;
  for (Runs& group : Grouped(paths::CircleRuns(paths.All(), options))) {
    std::vector<const Runs*> others;
    others.reserve(shifted.size());
    if (group.front().instrument == paths::kByLinkage) {
      for (const auto& one : shifted) others.push_back(&one[circles.size()]);
    }
    Runs longer;
    if (group.front().instrument == paths::kByBallbar)
      others.push_back(&(longer = LongerBar(group)));
    circles.push_back(Evaluate(std::move(group), others, paths, command));
  }
  return circles;
}

// The notes of the paths, and the reasons for missing figures.
std::vector<std::string> NotesOf(const MeasuredPaths& paths, const std::vector<Circle>& circles) {
  std::vector<std::string> notes = paths.notes;
  for (const Circle& circle : circles) {
    const paths::CircleRun& run = circle.runs.front();
    if (run.instrument == paths::kByBallbar && !run.u_length) {
      notes.push_back(fmt::format(
          "{}: the ballbar is not calibrated, so its length, and with it D, F max, F min and the "
          "mean of both scales, is taken as unknown to {:.0f} um: write u_length_um into its "
          "header if it is (abbe convert --u-length-um)",
          run.recordings.front(), kNotCalibrated / settings::kMicrometre));
    }
    if (run.is_programmed) continue;
    notes.push_back(fmt::format(
        "{}: does not state the programmed radius, so there are no F max, F min and D of ISO "
        "230-4: the circle of its x_mm, y_mm, z_mm ({:.6g} mm) may be that of scales, which lag "
        "reduces; write radius_mm into its header, or give --radius",
        run.recordings.front(), run.radius / settings::kMillimetre));
  }
  return notes;
}

// The figures of the first run are at the top level too, for scripts.
nlohmann::ordered_json Result(const MeasuredPaths& paths, const std::vector<Circle>& circles,
                              const std::vector<std::string>& notes) {
  nlohmann::ordered_json result = ResultHead("circle", paths);
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Circle& circle : circles) list.push_back(CircleJson(circle));
  const nlohmann::ordered_json& first = list.front();
  for (const char* key : {"plane", "radius_mm", "radius_is"}) result[key] = first[key];
  for (const auto& [key, value] : first["runs"].front().items()) {
    if (value.is_number_float() || key == "u" || key == "partial") result[key] = value;
  }
  if (first.contains("causes")) result["causes"] = first["causes"];
  result["circles"] = std::move(list);
  result["notes"] = notes;
  return result;
}

// Whether a circle is beyond --limit: G(b), or G if only one sense was measured.
bool BeyondLimit(const std::vector<Circle>& circles, double limit) {
  return std::ranges::any_of(circles, [limit](const Circle& circle) {
    return std::ranges::any_of(circle.figures, [limit](const paths::CircleFigures& figures) {
      const auto& iso = figures.iso;
      return (iso.both ? iso.both->G : iso.ccw ? iso.ccw->G : iso.cw->G) > limit;
    });
  });
}

int RunCircle(const CircleCommand& command) {
  const MeasuredPaths paths = ReadMeasuredPaths(command.sources);
  const std::vector<Circle> circles = Circles(paths, command);
  const std::vector<std::string> notes = NotesOf(paths, circles);
  if (!command.quiet) {
    fmt::print("{}", CircleTable(circles));
    for (const std::string& note : notes) fmt::print("note: {}\n", note);
  }
  const nlohmann::ordered_json result = Result(paths, circles, notes);
  if (!command.json.empty()) WriteResult(result, command.json);
  if (!command.out.empty()) {
    const std::string stem = command.sources.recordings.front().stem().string();
    WriteResult(result, command.out / (stem + "_circle.json"));
  }
  if (command.limit_um > 0.0 && BeyondLimit(circles, command.limit_um * settings::kMicrometre)) {
    fmt::print(stderr, "abbe: the circular deviation is beyond the limit of {} um\n",
               command.limit_um);
    return kRequirementNotMet;
  }
  return kDone;
}

}  // namespace

void AddCircle(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<CircleCommand>();
  CLI::App* command = program.add_subcommand(
      "circle", "Circular test: ISO 230-4 figures and their causes, by linkage and reference");
  AddPathSources(*command, options->sources);
  command->add_option("--plane", options->plane,
                      "Two axes, the first turning towards the second: XY, YZ, ZX (default: the "
                      "plane of the commanded path)");
  command
      ->add_option("--radius", options->radius_mm,
                   "Programmed radius, mm (default: radius_mm of the header)")
      ->check(PositiveNumber());
  command
      ->add_option("--filter", options->filter,
                   "Cutoff of the Gaussian filter of the figures, undulations per turn")
      ->check(PositiveNumber());
  command->add_option("--pitch", options->pitches,
                      "Axis and pitch in mm of cyclic errors to fit: --pitch X=5");
  command->add_option("--spike", options->spike_deg, "Width of reversal spikes, degrees")
      ->check(PositiveNumber())
      ->capture_default_str();
  command
      ->add_option("--limit", options->limit_um,
                   "Exit code 1 when the circular deviation is larger, um")
      ->check(PositiveNumber());
  command->add_option("-o,--out", options->out, "Folder for the result (RECORDING_circle.json)");
  command->add_option("--json", options->json, "File for the result");
  command->add_flag("--quiet", options->quiet, "No table");
  command->footer(
      "Example: abbe circle relm_cw.csv relm_ccw.csv grid.csv --machine mill.toml --out measured");
  command->callback([options, &exit_code] { exit_code = RunCircle(*options); });
}

}  // namespace abbe::apps
