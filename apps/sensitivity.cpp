// abbe sensitivity: Monte Carlo simulations of an instrument, the published ones by name.
#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/result_file.h"
#include "probes/published_simulations.h"

namespace abbe::apps {
namespace {

using probes::Inversion;
using probes::SimulationErrors;

struct SensitivityOptions {
  std::string simulation;
  probes::SimulationOptions run;
  std::filesystem::path json;
};

struct NamedInversion {
  Inversion inversion;
  const char* key;  // in the JSON file
  const char* title;
};
constexpr std::array<NamedInversion, 3> kInversions{{
    {Inversion::kSimplified, "components", "simplified inversion, nominal layout"},
    {Inversion::kExact, "exact", "exact inversion, nominal layout"},
    {Inversion::kCalibrated, "calibrated", "exact inversion, layout as it really stands"},
}};

nlohmann::ordered_json ToJson(const SimulationErrors& errors) {
  nlohmann::ordered_json components;
  for (std::size_t c = 0; c < probes::kComponents; ++c) {
    components[probes::kComponentNames[c]] = {
        {"worst", errors[c].worst}, {"mean", errors[c].mean}, {"std", errors[c].std}};
  }
  return components;
}

void Print(const SimulationErrors& errors, const char* title,
           const probes::PublishedBounds& published) {
  fmt::print("\n{}\n{:<10}{:>6}{:>12}{:>12}{:>12}{:>12}\n", title, "component", "unit", "worst",
             "mean", "std", "published");
  for (std::size_t c = 0; c < probes::kComponents; ++c) {
    const bool angle = c < probes::kEyx;
    const double scale = 1e6;  // urad, um
    fmt::print("{:<10}{:>6}{:>12.3g}{:>12.2g}{:>12.3g}{:>12g}\n", probes::kComponentNames[c],
               angle ? "urad" : "um", scale * errors[c].worst, scale * errors[c].mean,
               scale * errors[c].std, scale * (angle ? published.angle : published.translation));
  }
}

int RunSensitivity(SensitivityOptions options) {
  options.run.simulation =
      options.simulation == "I" ? probes::Simulation::kOne : probes::Simulation::kTwo;
  fmt::print("Simulation {}: errors, estimated minus true, of {} draws, seed {}\n",
             options.simulation, options.run.draws, options.run.seed);
  nlohmann::ordered_json result{
      {"simulation", options.simulation}, {"draws", options.run.draws}, {"seed", options.run.seed}};
  const probes::PublishedBounds published = probes::BoundsOf(options.run.simulation);
  result["published"] = {{"angle", published.angle}, {"translation", published.translation}};
  for (const NamedInversion& named : kInversions) {
    options.run.inversion = named.inversion;
    const SimulationErrors errors = probes::RunSimulation(options.run);
    Print(errors, named.title, published);
    result[named.key] = ToJson(errors);
  }
  if (options.run.simulation == probes::Simulation::kOne) {
    fmt::print("\nThe published translation is that of one run of 61 draws.\n");
  }
  if (!options.json.empty()) WriteResult(result, options.json);
  return kDone;
}

}  // namespace

void AddSensitivity(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<SensitivityOptions>();
  CLI::App* command = program.add_subcommand(
      "sensitivity", "Monte Carlo of the probe head: the published simulations I and II");
  command
      ->add_option("--simulation", options->simulation,
                   "I: the inversion alone; II: also a head out of place")
      ->required()
      ->check(CLI::IsMember({"I", "II"}));
  command->add_option("--draws", options->run.draws, "Number of draws")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--threads", options->run.threads, "Threads, 0 for all")
      ->capture_default_str();
  command->add_option("--seed", options->run.seed, "Seed of the random numbers")
      ->capture_default_str();
  command->add_option("--json", options->json, "Write the result as data (SI units)");
  command->footer("Example: abbe sensitivity --simulation II --draws 1000000 --json out/II.json");
  command->callback([options, &exit_code] { exit_code = RunSensitivity(*options); });
}

}  // namespace abbe::apps
