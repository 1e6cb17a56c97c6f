// abbe study: one question asked of many worlds, on all processors or by MPI, kept in a store.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/fill_store.h"
#include "failure/failure.h"
#include "recording/file_hash.h"
#include "recording/whole_file.h"
#include "study/deal.h"
#include "study/kinds.h"
#include "study/store.h"

namespace abbe::apps {
namespace {

namespace fs = std::filesystem;

struct StudyOptions {
  study::Question question;
  std::uint64_t worlds = 100, seed = 1;
  fs::path store;
  bool resume = false;
  std::string shard = "1/1";
  FillOptions fill;
};

struct Shard {
  std::uint64_t number = 1, count = 1;
};

Shard ParseShard(const std::string& text) {
  Shard shard;
  const char* end = text.data() + text.size();
  const auto [slash, wrong] = std::from_chars(text.data(), end, shard.number);
  const bool has_slash = wrong == std::errc() && slash != end && *slash == '/';
  const auto [rest, also_wrong] = has_slash
                                      ? std::from_chars(slash + 1, end, shard.count)
                                      : std::from_chars_result{slash, std::errc::invalid_argument};
  if (also_wrong != std::errc() || rest != end || shard.number < 1 || shard.number > shard.count) {
    throw InputError(
        fmt::format("--shard {}: is not a part of a whole; give for example 2/8", text));
  }
  return shard;
}

study::Row QuestionOf(const study::StudyKind& kind, const study::Question& question) {
  return {{"abbe_study", kind.name},
          {"variant", question.variant},
          {"machine", question.machine.filename().string()},
          {"machine_sha256", recording::Sha256OfFile(question.machine)},
          {"version", ABBE_VERSION}};
}

std::vector<std::uint64_t> SeedsOf(const StudyOptions& options, const Shard& shard) {
  std::vector<std::uint64_t> seeds;
  for (std::uint64_t i = shard.number - 1; i < options.worlds; i += shard.count) {
    seeds.push_back(options.seed + i);
  }
  return seeds;
}

// Prints it; false where a bound is refuted.
bool Show(const study::Row& question, const study::Stored& stored) {
  const study::StudyKind& kind = study::StudyNamed(question.at("abbe_study").get<std::string>());
  const std::string variant = question.value("variant", "");
  const std::vector<study::Row> good = stored.Good();
  const std::size_t failed = stored.rows.size() - good.size();
  fmt::print("Study {}{}{} of {}: {} worlds, seeds {} to {}", kind.name, variant.empty() ? "" : " ",
             variant, question.value("machine", "?"), stored.rows.size(),
             stored.rows.begin()->first, stored.rows.rbegin()->first);
  fmt::print("{}\n", failed == 0 ? "" : fmt::format("; {} failed", failed));
  for (const auto& [seed, row] : stored.rows) {
    if (row.contains("failed")) {
      fmt::print("seed {} failed: {}\n", seed, row.at("failed").get<std::string>());
    }
  }
  if (good.empty()) return false;
  const study::Summary summary = kind.sum(variant, good);
  if (!summary.text.empty()) fmt::print("\n{}", summary.text);
  bool is_met = failed == 0;
  if (!summary.bounds.empty()) fmt::print("\n| | worlds | asked | |\n|---|---|---|---|\n");
  for (const study::Bound& bound : summary.bounds) {
    const bool refuted = bound.IsRefuted();
    std::string asked;
    if (bound.least > 0.0) asked = fmt::format("at least {:g} %", 100.0 * bound.least);
    if (bound.most < 1.0) {
      asked += fmt::format("{}at most {:g} %", asked.empty() ? "" : ", ", 100.0 * bound.most);
    }
    fmt::print("| {} | {} | {} | {} |\n", bound.what, bound.rate.Text(), asked,
               refuted ? "NOT MET" : "not refuted");
    is_met &= !refuted;
  }
  return is_met;
}

int RunStudy(const study::StudyKind& kind, const StudyOptions& options) {
  study::Ranks ranks;
  const std::unique_ptr<const study::Study> asked = kind.make(options.question);
  if (ranks.number() > 0) {
    study::Deal(*asked, {}, ranks, {});
    return kDone;
  }
  const Shard shard = ParseShard(options.shard);
  const study::Row question = QuestionOf(kind, options.question);
  const bool goes_on = options.resume && fs::exists(options.store);
  study::Store store = study::Store::Open(options.store, question,
                                          goes_on ? study::Store::kGoOn : study::Store::kNew);
  if (!FillStore(*asked, SeedsOf(options, shard), fmt::format("study {}", kind.name), options.fill,
                 ranks, store, [](std::uint64_t seed) { return fmt::format("seed {}", seed); })) {
    return kRequirementNotMet;
  }
  const bool is_met = ReadRows(options.store, [&] {
    return Show(question, {question, store.rows()});
  });
  fmt::print("\nRows: {}\n", options.store.string());
  return is_met ? kDone : kRequirementNotMet;
}

void AddKind(CLI::App& studies, const study::StudyKind& kind, int& exit_code) {
  auto options = std::make_shared<StudyOptions>();
  CLI::App* command = studies.add_subcommand(std::string(kind.name), std::string(kind.what));
  command->add_option("--machine", options->question.machine, "Machine file")
      ->required()
      ->check(CLI::ExistingFile);
  if (!kind.variants.empty()) {
    const std::vector<std::string> variants(kind.variants.begin(), kind.variants.end());
    options->question.variant = variants.front();
    command->add_option("--variant", options->question.variant, "What is asked")
        ->check(CLI::IsMember(variants))
        ->capture_default_str();
  }
  command->add_option("--worlds", options->worlds, "Number of worlds")
      ->check(CLI::Range(1, 100'000'000))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of the first world")->capture_default_str();
  command->add_option("--store", options->store, "File that keeps a row of each world")->required();
  command->add_flag("--resume", options->resume, "Go on with the worlds that the store lacks");
  command->add_option("--shard", options->shard, "Part k of n of the worlds, \"k/n\"")
      ->capture_default_str();
  command
      ->add_option("--threads", options->fill.threads,
                   "Worlds at once, 0: all processors, or one for each process of mpirun")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  command->add_flag("--quiet", options->fill.quiet, "No progress");
  command->footer(fmt::format(
      "Example: abbe study {0} --machine machines/demo_mill.toml --worlds 1000 --store {0}.jsonl",
      kind.name));
  command->callback([options, &kind, &exit_code] { exit_code = RunStudy(kind, *options); });
}

void AddStores(CLI::App& command, const std::shared_ptr<std::vector<fs::path>>& stores) {
  command.add_option("stores", *stores, "Stores of one question, as of its shards")
      ->required()
      ->check(CLI::ExistingFile);
}

void AddShow(CLI::App& studies, int& exit_code) {
  auto stores = std::make_shared<std::vector<fs::path>>();
  CLI::App* command = studies.add_subcommand("show", "What the rows of stores say together");
  AddStores(*command, stores);
  command->footer("Example: abbe study show one.jsonl two.jsonl");
  command->callback([stores, &exit_code] {
    const study::Stored stored = study::ReadStores(*stores);
    if (stored.rows.empty()) {
      throw InputError(fmt::format("{}: no world is in it yet", stores->front().string()));
    }
    const bool is_met = ReadRows(stores->front(), [&] { return Show(stored.question, stored); });
    exit_code = is_met ? kDone : kRequirementNotMet;
  });
}

void AddMerge(CLI::App& studies) {
  auto stores = std::make_shared<std::vector<fs::path>>();
  auto out = std::make_shared<fs::path>();
  CLI::App* command = studies.add_subcommand("merge", "One store of those of the shards");
  AddStores(*command, stores);
  command->add_option("--out,-o", *out, "Store to write")->required();
  command->footer("Example: abbe study merge one.jsonl two.jsonl -o both.jsonl");
  command->callback([stores, out] {
    const study::Stored stored = study::ReadStores(*stores);
    recording::WriteWhole(study::TextOf(stored.question, stored.rows), *out);
    fmt::print("{}: {} worlds\n", out->string(), stored.rows.size());
  });
}

}  // namespace

void AddStudy(CLI::App& program, int& exit_code) {
  CLI::App* studies = program.add_subcommand(
      "study", "Ask one question of many simulated worlds: on all processors, or under mpirun");
  studies->require_subcommand(1);
  for (const study::StudyKind& kind : study::StudyKinds()) AddKind(*studies, kind, exit_code);
  AddShow(*studies, exit_code);
  AddMerge(*studies);
  studies->footer(
      "Example: mpirun -n 8 abbe study head --machine machines/demo_mill.toml --store head.jsonl");
}

}  // namespace abbe::apps
