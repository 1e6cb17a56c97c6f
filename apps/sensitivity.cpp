// abbe sensitivity: Monte Carlo of an instrument: the published simulations of the head by
// name, or the linkage of a machine file.
#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/error_model_option.h"
#include "apps/result_file.h"
#include "apps/sensitivity_linkage.h"
#include "probes/published_simulations.h"

namespace abbe::apps {
namespace {

using probes::Inversion;
using probes::SimulationErrors;

struct SensitivityOptions {
  std::string simulation;
  probes::SimulationOptions run;
  LinkageSensitivityOptions linkage;
  std::optional<std::uint64_t> draws;  // each instrument has its own default
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
    {Inversion::kCalibrated, "calibrated", "exact inversion, true layout"},
}};

nlohmann::ordered_json ToJson(const SimulationErrors& errors) {
  nlohmann::ordered_json components;
  for (std::size_t c = 0; c < probes::kPublishedComponents; ++c) {
    components[probes::kComponentNames[c]] = {
        {"worst", errors[c].worst}, {"mean", errors[c].mean}, {"std", errors[c].std}};
  }
  return components;
}

void Print(const SimulationErrors& errors, const char* title,
           const probes::PublishedBounds& published) {
  fmt::print("\n{}\n{:<10}{:>6}{:>12}{:>12}{:>12}{:>12}\n", title, "component", "unit", "worst",
             "mean", "std", "published");
  for (std::size_t c = 0; c < probes::kPublishedComponents; ++c) {
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
    fmt::print("\nThe published translation is from a single run of 61 draws.\n");
  }
  if (!options.json.empty()) WriteResult(result, options.json);
  return kDone;
}

void AddLinkageOptions(CLI::App& command, CLI::Option* linkage,
                       LinkageSensitivityOptions& options) {
  AddErrorModelOption(command, options.model)->needs(linkage);
  command.add_option("--volume", options.size_mm, "Edges of the volume, mm")
      ->expected(3)
      ->capture_default_str()
      ->needs(linkage);
  command.add_option("--centre", options.centre_mm, "Centre of the volume in the machine, mm")
      ->expected(3)
      ->capture_default_str()
      ->needs(linkage);
  command.add_option("--points", options.points, "Poses along each edge")
      ->check(CLI::Range(1, 50))
      ->capture_default_str()
      ->needs(linkage);
  command
      .add_option("--warmth", options.warmth_c,
                  "Temperature of the links above their reference, degC")
      ->capture_default_str()
      ->needs(linkage);
  command
      .add_flag("--displacement", options.run.displacement, "Errors relative to that of the centre")
      ->needs(linkage);
}

int Run(SensitivityOptions options) {
  if (options.linkage.machine.empty()) {
    if (options.draws) options.run.draws = *options.draws;
    return RunSensitivity(options);
  }
  if (options.draws) options.linkage.run.draws = *options.draws;
  options.linkage.run.seed = options.run.seed;
  options.linkage.run.threads = options.run.threads;
  options.linkage.json = options.json;
  return RunLinkageSensitivity(options.linkage);
}

}  // namespace

void AddSensitivity(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<SensitivityOptions>();
  CLI::App* command = program.add_subcommand(
      "sensitivity", "Monte Carlo of the probe head (simulations I and II) or of the linkage");
  auto* instrument = command->add_option_group("instrument")->require_option(1);
  instrument
      ->add_option("--simulation", options->simulation,
                   "Simulation of the head. I: the inversion only; II: also a misplaced head")
      ->check(CLI::IsMember({"I", "II"}));
  auto* linkage =
      instrument->add_option("--linkage", options->linkage.machine,
                             "Linkage of this machine file: from tolerances to the tip");
  AddLinkageOptions(*command, linkage, options->linkage);
  command->add_option("--draws", options->draws, "Number of draws (head 20000, linkage 2048)")
      ->check(CLI::Range(1, 1'000'000'000));
  command->add_option("--threads", options->run.threads, "Threads, 0 for all")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_option("--seed", options->run.seed, "Seed of the random numbers")
      ->capture_default_str();
  command->add_option("--json", options->json, "Write the result as data (SI units)");
  command->footer(
      "Example: abbe sensitivity --simulation II --draws 1000000 --json out/II.json\n"
      "         abbe sensitivity --linkage machines/demo_mill.toml --displacement");
  command->callback([options, &exit_code] { exit_code = Run(*options); });
}

}  // namespace abbe::apps
