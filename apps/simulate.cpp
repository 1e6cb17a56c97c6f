// abbe simulate: the figures of a test piece made on a machine with the errors of a map.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "apps/causes_option.h"
#include "apps/command.h"
#include "apps/commands.h"
#include "apps/map_option.h"
#include "apps/path_table.h"
#include "apps/result_file.h"
#include "compensation/performance.h"
#include "failure/failure.h"
#include "failure/located.h"

namespace abbe::apps {
namespace {

using compensation::Figure;

struct SimulateCommand {
  MapOption map;
  std::string test;
  std::filesystem::path path, json;
  CausesOption causes;
  double radius_mm = 0.0, feed_mm_min = 0.0;
  bool corrected = false, quiet = false;
  int draws = 200;
  std::uint64_t seed = 1;
};

nlohmann::ordered_json FiguresOf(const std::vector<Figure>& figures) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const Figure& figure : figures) {
    json[fmt::format("{} {}", figure.name, figure.unit)] = figure.value * 1e6;
  }
  return json;
}

void Print(const std::vector<Figure>& before, const std::vector<Figure>& after) {
  fmt::print("{:<24}{:>12}{}\n", "", "as it is", after.empty() ? "" : "   corrected (95 %)");
  for (std::size_t i = 0; i < before.size(); ++i) {
    fmt::print("{:<24}{:>12.2f}", before[i].name, before[i].value * 1e6);
    if (!after.empty()) fmt::print("{:>19.2f}", after[i].value * 1e6);
    fmt::print(" {}\n", before[i].unit);
  }
}

int Simulate(const SimulateCommand& options) {
  const map::ErrorMap map = options.map.Read();
  const Eigen::Vector3d tool = options.map.Tool(map);
  compensation::TestSize size;
  size.radius = options.radius_mm * 1e-3;
  if (!options.path.empty()) size.path = ReadPathTable(options.path);
  auto test = compensation::MakeTest(options.test, map, size);
  const PathCauses causes(options.causes, map.origin().machine, options.feed_mm_min);
  if (causes.Active()) {
    test.evaluate = [evaluate = test.evaluate, beside = causes.Beside(test.wanted)](
                        const Eigen::Matrix3Xd& made) { return evaluate(made + beside); };
  }
  const std::string where = options.path.empty() ? "the test" : options.path.string();
  const auto before = test.evaluate(
      Located(where, [&] { return compensation::MadeBy(map.model(), tool, test.wanted); }));
  std::vector<Figure> after;
  if (options.corrected) {
    after = compensation::AfterCorrection(map, tool, test, options.draws, options.seed);
  }
  if (!options.quiet) {
    fmt::print("{} on {} {}\n", options.test, map.origin().machine, map.model().chain().Text());
    Print(before, after);
    if (causes.Active()) fmt::print("{}\n", causes.Line());
  }
  if (!options.json.empty()) {
    nlohmann::ordered_json result = {{"abbe", ABBE_VERSION},
                                     {"command", "simulate"},
                                     {"machine", map.origin().machine},
                                     {"chain", map.model().chain().Text()},
                                     {"map", options.map.path.filename()},
                                     {"scale", map.Scale()},
                                     {"test", options.test},
                                     {"as_is", FiguresOf(before)}};
    if (options.corrected) result["corrected_95"] = FiguresOf(after);
    causes.AddTo(result);
    WriteResult(result, options.json);
  }
  return kDone;
}

}  // namespace

void AddSimulate(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<SimulateCommand>();
  CLI::App* command = program.add_subcommand(
      "simulate", "Figures of a test piece made on a machine with the errors of a map");
  options->map.AddTo(*command);
  command
      ->add_option("--test", options->test,
                   fmt::format("{}", fmt::join(compensation::TestNames(), ", ")))
      ->required();
  command->add_option("--path", options->path, "freeform: a table with x_mm, y_mm, z_mm");
  command
      ->add_option("--radius-mm", options->radius_mm,
                   "Radius of circle and cylinder, half the side of the square (0.39 of a travel)")
      ->check(PositiveNumber());
  AddPathCauses(*command, options->causes, options->feed_mm_min);
  command->add_flag("--corrected", options->corrected,
                    "Also the figures after correction by the map: its own uncertainty");
  command->add_option("--draws", options->draws,
                      "With --corrected: number of drawn machines (200)");
  command->add_option("--seed", options->seed, "Seed of the draws (1)");
  command->add_option("--json", options->json, "The figures as data");
  command->add_flag("--quiet", options->quiet, "Print nothing but warnings");
  command->footer("Example: abbe simulate out/map.toml --test circle --corrected");
  command->callback([options, &exit_code] { exit_code = Simulate(*options); });
}

}  // namespace abbe::apps
