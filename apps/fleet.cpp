// abbe fleet: what the machines of one type have in common, and which of them is odd.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/fill_store.h"
#include "apps/instruments.h"
#include "apps/machine_recording.h"
#include "apps/result_file.h"
#include "failure/failure.h"
#include "fleet/odd_machines.h"
#include "fleet/population_fit.h"
#include "fusion/fuse_sources.h"
#include "recording/file_hash.h"
#include "recording/recording_file.h"
#include "settings/toml_text.h"
#include "simulation/kinds.h"
#include "study/store.h"

namespace abbe::apps {
namespace {

namespace fs = std::filesystem;
using Eigen::Index;

constexpr double kFollowed = 0.6;  // correlation length over that of the file: fleet::KnotsOf
constexpr double kMostOdds = 6.0;  // log10; beyond it the form of the population decides

struct FleetOptions {
  std::vector<std::string> campaigns;  // "A12=folder"
  fs::path machine, store, out, json;
  fleet::IdentityOptions identity;
  bool resume = false;
  FillOptions fill;
};

struct Given {
  std::string machine;
  fs::path folder;
  std::vector<fs::path> recordings;  // of kinds that make maps
};

// In the order of their names.
std::vector<fs::path> RecordingsIn(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> paths;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    const fs::path extension = entry->path().extension();
    if (extension != ".csv" && extension != ".h5") continue;
    if (simulation::KindOf(recording::ReadHead(entry->path())).MakesMaps()) {
      paths.push_back(entry->path());
    }
  }
  if (error) {
    throw InputError(fmt::format("{}: cannot be read as a folder: {}; give that of a campaign",
                                 folder.string(), error.message()));
  }
  if (paths.empty()) {
    throw InputError(
        fmt::format("{}: has no recording that makes a map ({}); give the folder of a "
                    "campaign",
                    folder.string(), simulation::KindNames(&simulation::RunKind::MakesMaps)));
  }
  std::ranges::sort(paths);
  return paths;
}

Given ParseGiven(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size()) {
    throw InputError(
        fmt::format("{}: give each campaign as MACHINE=FOLDER, for example "
                    "A12=campaigns/a12",
                    text));
  }
  const fs::path folder = text.substr(equals + 1);
  return {text.substr(0, equals), folder, RecordingsIn(folder)};
}

// The same for the same recordings of the same machine.
std::uint64_t NumberOf(const Given& given) {
  std::string all = given.machine;
  for (const fs::path& path : given.recordings) all += recording::Sha256OfFile(path);
  constexpr int kDigits = 13;  // of a double
  return std::stoull(recording::Sha256OfText(all).substr(0, kDigits), nullptr, 16);
}

std::vector<double> LowerTriangle(const Eigen::MatrixXd& full) {
  std::vector<double> values;
  for (Index i = 0; i < full.rows(); ++i) {
    for (Index j = 0; j <= i; ++j) values.push_back(full(i, j));
  }
  return values;
}

// InputError where they are not those of an n x n matrix.
Eigen::MatrixXd FromLowerTriangle(const std::vector<double>& values, Index n) {
  if (std::ssize(values) != n * (n + 1) / 2)
    throw InputError("a row has information of another size; make the store anew");
  Eigen::MatrixXd full(n, n);
  auto at = values.begin();
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j <= i; ++j) full(i, j) = full(j, i) = *at++;
  }
  return full;
}

// What each campaign tells, as a study over campaigns instead of worlds.
class Gathering : public study::Study {
 public:
  Gathering(simulation::Instruments instruments, std::map<std::uint64_t, Given> campaigns)
      : instruments_(std::move(instruments)), campaigns_(std::move(campaigns)) {}

  study::Row World(std::uint64_t number) const override {
    const Given& given = campaigns_.at(number);
    std::vector<simulation::RunSource> sources;
    for (const fs::path& path : given.recordings) {
      sources.push_back(SourceAt(instruments_.machine, path));
    }
    simulation::RefuseStrangers(sources, instruments_);
    const fusion::FuseReport report = fusion::FuseSources(
        sources, instruments_, {.knots = fleet::KnotsOf(instruments_.machine), .threads = 1});
    return {{"machine", given.machine},
            {"campaign", given.folder.string()},
            {"contradiction", report.contradicting >= 0},
            {"information", LowerTriangle(report.seen.information)},
            {"vector", std::vector<double>(report.seen.vector.begin(), report.seen.vector.end())}};
  }

 private:
  simulation::Instruments instruments_;
  std::map<std::uint64_t, Given> campaigns_;
};

// The model has n parameters.
fleet::Campaign CampaignOf(const study::Row& row, Index n) {
  const std::vector<double> vector = study::NumbersOf(row, "vector", n);
  fleet::Campaign campaign{row.at("machine"),
                           row.at("campaign"),
                           {FromLowerTriangle(row.at("information").get<std::vector<double>>(), n),
                            Eigen::Map<const Eigen::VectorXd>(vector.data(), n)}};
  constexpr double kRounding = 1e-9;
  Eigen::MatrixXd positive = campaign.seen.information;
  positive.diagonal().array() += kRounding * positive.diagonal().maxCoeff();
  if (!positive.allFinite() || Eigen::LLT<Eigen::MatrixXd>(positive).info() != Eigen::Success) {
    throw InputError("a row has information that is not positive; make the store anew");
  }
  return campaign;
}

// "2.13 (1.98 to 2.29)": with U95.
std::string SeenText(const fusion::Statement& line) {
  if (!std::isfinite(line.u_log)) return "the fleet does not tell";
  const double seen = line.seen / line.unit, factor = std::exp(2.0 * line.u_log);
  return fmt::format("{:.3g} ({:.3g} to {:.3g})", seen, seen / factor, seen * factor);
}

std::string KeyOf(const fusion::Statement& line) {
  return std::string(line.key.substr(line.key.find('.') + 1));
}

// The table [population] for the machine file of a new machine of this type.
std::string PopulationText(const fleet::PopulationFit& fit) {
  std::string text =
      fmt::format("# Of {} machines, by abbe fleet fit.\n[population]\n", fit.machines().size());
  for (const fusion::Statement& line : fit.statements()) {
    const bool told = std::isfinite(line.u_log);
    text += fmt::format("{} = {}{}\n", KeyOf(line),
                        settings::Float((told ? line.seen : line.stated) / line.unit),
                        told ? "" : "  # as before: the fleet does not tell");
  }
  return text;
}

std::string FitText(const fleet::PopulationFit& fit, const std::vector<fleet::OddError>& errors,
                    const std::vector<fleet::OddIdentity>& identities, double change) {
  std::string text = fmt::format(
      "{} machines\n\n| population | file | fleet (U95) |\n|---|---|---|\n", fit.machines().size());
  for (const fusion::Statement& line : fit.statements()) {
    text +=
        fmt::format("| {} | {:.3g} | {} |\n", KeyOf(line), line.stated / line.unit, SeenText(line));
  }
  const fusion::Statement& smoothness = fit.statements().back();
  if (smoothness.seen < kFollowed * smoothness.stated) {
    text +=
        "The fleet is rougher than its model can follow: put this table into the machine file "
        "and fit once more, into another store.\n";
  }
  text += "\nOdd parts, errors of a size that the others do not have:\n";
  if (errors.empty()) text += "none\n";
  for (const fleet::OddError& odd : errors) {
    text += fmt::format("{} {}: {:.1f} times the size of the population; ", odd.machine, odd.error,
                        odd.times);
    text += odd.is_certain()
                ? fmt::format("not by chance (p = {:.2g})\n", odd.p_value)
                : fmt::format("{:.2g} such cases are expected by chance\n", odd.by_chance);
  }
  text += fmt::format(
      "\nSwapped identities (errors change by {:g} of their size between campaigns):\n", change);
  if (identities.empty()) text += "none\n";
  for (const fleet::OddIdentity& odd : identities) {
    const std::string odds = odd.log10_odds > kMostOdds ? fmt::format("above 1e{:.0f}", kMostOdds)
                                                        : fmt::format("1e{:.0f}", odd.log10_odds);
    text += fmt::format(
        "{}: said to be {}, {}, odds {}\n", odd.campaign, odd.said,
        odd.fits.empty() ? "fits none of the machines, or has changed by more" : "fits " + odd.fits,
        odds);
  }
  return text;
}

nlohmann::ordered_json FitJson(const fleet::PopulationFit& fit,
                               const std::vector<fleet::OddError>& errors,
                               const std::vector<fleet::OddIdentity>& identities) {
  nlohmann::ordered_json json{{"command", "fleet fit"}, {"machines", fit.machines()}};
  for (const fusion::Statement& line : fit.statements()) {
    auto& one = json["population"][KeyOf(line)];
    one = {{"file", line.stated / line.unit}};
    if (!std::isfinite(line.u_log)) continue;
    one["fleet"] = line.seen / line.unit;
    one["u_log"] = line.u_log;
  }
  json["odd_errors"] = nlohmann::ordered_json::array();
  for (const auto& odd : errors) {
    json["odd_errors"].push_back({{"machine", odd.machine},
                                  {"error", odd.error},
                                  {"times", odd.times},
                                  {"p_value", odd.p_value},
                                  {"by_chance", odd.by_chance},
                                  {"certain", odd.is_certain()}});
  }
  json["odd_identities"] = nlohmann::ordered_json::array();
  for (const auto& odd : identities) {
    json["odd_identities"].push_back({{"campaign", odd.campaign},
                                      {"said", odd.said},
                                      {"fits", odd.fits},
                                      {"log10_odds", std::min(odd.log10_odds, kMostOdds)}});
  }
  return json;
}

// The rows of the campaigns that were given, or all of the store.
std::vector<fleet::Campaign> CampaignsOf(const study::Rows& rows, Index parameters,
                                         const std::map<std::uint64_t, Given>& given) {
  std::vector<fleet::Campaign> campaigns;
  for (const auto& [number, row] : rows) {
    if (!given.empty() && !given.contains(number)) continue;
    if (row.contains("failed")) {
      fmt::print(stderr, "abbe: a campaign is left out: {}\n", row.at("failed").get<std::string>());
      continue;
    }
    campaigns.push_back(CampaignOf(row, parameters));
    if (row.at("contradiction").get<bool>()) {
      fmt::print(stderr, "abbe: {}: its runs contradict each other; look at it by abbe fuse\n",
                 campaigns.back().name);
    }
  }
  return campaigns;
}

int FitFleet(const FleetOptions& options) {
  study::Ranks ranks;
  simulation::Instruments instruments = ReadInstruments(options.machine);
  const machine::Machine machine = instruments.machine;
  std::map<std::uint64_t, Given> given;
  for (const std::string& text : options.campaigns) {
    Given campaign = ParseGiven(text);
    const std::uint64_t number = NumberOf(campaign);
    if (!given.emplace(number, std::move(campaign)).second) {
      throw InputError(
          fmt::format("{}: is given twice, and would count twice; give it once", text));
    }
  }
  const Gathering gathering(std::move(instruments), given);
  if (ranks.number() > 0) {
    study::Deal(gathering, {}, ranks, {});
    return kDone;
  }
  study::Store store = study::Store::Open(
      options.store,
      {{"abbe_study", "fleet"},
       {"machine", options.machine.filename().string()},
       {"machine_sha256", recording::Sha256OfFile(options.machine)},
       {"knots_m", fleet::KnotsOf(machine)},
       {"version", ABBE_VERSION}},
      options.resume && fs::exists(options.store) ? study::Store::kGoOn : study::Store::kNew);
  std::vector<std::uint64_t> numbers;
  numbers.reserve(given.size());
  for (const auto& [number, campaign] : given) numbers.push_back(number);
  if (!FillStore(gathering, numbers, "fleet", options.fill, ranks, store,
                 [&](std::uint64_t number) { return given.at(number).folder.string(); }))
    return kRequirementNotMet;
  const machine::VolumetricModel model = fusion::UnknownMachine(machine, fleet::KnotsOf(machine));
  const std::vector<fleet::Campaign> campaigns = ReadRows(options.store, [&] {
    auto rows = CampaignsOf(store.rows(), model.ParameterCount(), given);
    if (rows.empty()) throw InputError("a fleet needs a campaign of a machine; give one");
    return rows;
  });
  const fleet::PopulationFit fit(machine, model, campaigns);
  const auto errors = fleet::OddErrors(fit);
  const auto identities = fleet::OddIdentities(fit, campaigns, options.identity);
  fmt::print("{}", FitText(fit, errors, identities, options.identity.change));
  if (!options.json.empty()) WriteResult(FitJson(fit, errors, identities), options.json);
  if (!options.out.empty()) {
    WriteText(PopulationText(fit), options.out);
    fmt::print("\nfor the machine file of a new one: {}\n", options.out.string());
  }
  return kDone;
}

}  // namespace

void AddFleet(CLI::App& program, int& exit_code) {
  CLI::App* fleet = program.add_subcommand("fleet", "What the machines of one type have in common");
  fleet->require_subcommand(1);
  auto options = std::make_shared<FleetOptions>();
  CLI::App* command = fleet->add_subcommand(
      "fit", "The population of a fleet, its odd parts, campaigns of swapped identity");
  command->add_option("campaigns", options->campaigns,
                      "MACHINE=FOLDER for each campaign; none: all that the store has");
  command->add_option("--machine", options->machine, "Machine file of the type")->required();
  command->add_option("--store", options->store, "File that keeps what each campaign tells")
      ->required();
  command
      ->add_option("--change", options->identity.change,
                   "Change of a machine's errors between campaigns, in sizes of the population")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  command
      ->add_option("--threads", options->fill.threads,
                   "Campaigns at once, 0: all processors, or one for each process of mpirun")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_flag("--resume", options->resume,
                    "Go on with the store: only campaigns that it lacks");
  command->add_option("-o,--out", options->out, "[population] for the machine file of a new one");
  command->add_option("--json", options->json, "File for the result as data");
  command->add_flag("--quiet", options->fill.quiet, "No progress");
  command->footer(
      "Example: abbe fleet fit A12=campaigns/a12 A13=campaigns/a13 --machine mill.toml --store "
      "fleet.jsonl -o population.toml");
  command->callback([options, &exit_code] { exit_code = FitFleet(*options); });
}

}  // namespace abbe::apps
