// abbe history: what was measured on machines, kept, compared, followed and checked.
#include <memory>
#include <string>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/history_options.h"

namespace abbe::apps {
namespace {

class Subcommands {
 public:
  Subcommands(CLI::App& history, int& exit_code)
      : history_(history), exit_code_(exit_code), options_(std::make_shared<HistoryOptions>()) {}

  CLI::App* Make(const char* name, const char* about, const char* example,
                 int (*run)(const HistoryOptions&)) {
    CLI::App* command = history_.add_subcommand(name, about);
    command->add_option("--store", options_->store,
                        "File, or postgresql://... (default: history.db of the user's data)");
    command->footer(std::string("Example: ") + example);
    command->callback(
        [options = options_, &exit_code = exit_code_, run] { exit_code = run(*options); });
    return command;
  }

  void WithJson(CLI::App* command) {
    command->add_option("--json", options_->json, "File for the result as data");
    command->add_flag("--quiet", options_->quiet, "No table");
  }
  void WithMachine(CLI::App* command) {
    command->add_option("--machine", options_->machine, "Name of the machine");
  }
  HistoryOptions& options() { return *options_; }

 private:
  CLI::App& history_;
  int& exit_code_;
  std::shared_ptr<HistoryOptions> options_;
};

void AddKeeping(Subcommands& sub) {
  HistoryOptions& options = sub.options();
  CLI::App* add = sub.Make("add", "Keep a campaign: a folder, or files",
                           "abbe history add measured --machine mill.toml --note \"after service\"",
                           AddCampaigns);
  add->add_option("from", options.from,
                  "Folders (a campaign each), or results, recordings and maps (one campaign)")
      ->required();
  add->add_option("--machine", options.machine_file, "Machine file, kept with the campaign");
  add->add_option("--note", options.note, "What the campaign was for");
  add->add_option("--operator", options.who, "Who measured (default: as the results say)");
  add->add_option("--measured", options.measured,
                  "When, as 2026-11-21T09:00:00Z (default: as the results say)");
  add->add_option("--instrument", options.instruments,
                  "ROLE=NAME, for example head=P-12, target=T-3, length=IF-7; repeatable")
      ->allow_extra_args(false);
  add->add_flag("--quiet", options.quiet, "Print nothing but warnings");

  CLI::App* list =
      sub.Make("list", "The campaigns", "abbe history list --machine mill", ListCampaigns);
  sub.WithMachine(list);
  sub.WithJson(list);

  CLI::App* show =
      sub.Make("show", "One campaign with its figures", "abbe history show 3", ShowCampaign);
  show->add_option("campaign", options.campaign, "Its number, or latest")->required();
  sub.WithMachine(show);
  sub.WithJson(show);

  CLI::App* forget =
      sub.Make("forget", "Take a campaign out", "abbe history forget 3", ForgetCampaign);
  forget->add_option("campaign", options.campaign, "Its number, or latest")->required();
  sub.WithMachine(forget);
  forget->add_flag("--quiet", options.quiet, "Print nothing");

  CLI::App* out = sub.Make("export", "All figures as a table, or everything as JSON",
                           "abbe history export --format csv --out figures.csv", ExportHistory);
  out->add_option("--format", options.format, "csv: the figures; json: all that is kept")
      ->check(CLI::IsMember({"csv", "json"}))
      ->capture_default_str();
  sub.WithMachine(out);
  out->add_option("--out", options.out, "File (default: standard output)");
}

void AddJudging(Subcommands& sub) {
  HistoryOptions& options = sub.options();
  CLI::App* compare =
      sub.Make("compare", "What changed between two campaigns",
               "abbe history compare 3 latest --json compare.json", CompareCampaigns);
  compare->add_option("before", options.campaign, "Number of a campaign, or latest")->required();
  compare->add_option("after", options.other, "Number of another")->required();
  compare->add_option("--level", options.level, "Chance of any false alarm among all differences")
      ->check(CLI::Range(1e-6, 0.5))
      ->capture_default_str();
  sub.WithMachine(compare);
  sub.WithJson(compare);

  CLI::App* trend = sub.Make("trend", "A figure over time, and when it meets its limit",
                             "abbe history trend EYX --machine mill", FollowFigures);
  trend->add_option("figure", options.figure, "EYX, straightness_um or EYX.straightness_um")
      ->required();
  sub.WithMachine(trend);
  sub.WithJson(trend);

  CLI::App* check = sub.Make("check", "Figures against the limits of the machine file",
                             "abbe history check measured --machine mill.toml", CheckLimits);
  check->add_option("of", options.campaign, "A folder with results, or a campaign of the history")
      ->required();
  check->add_option("--machine", options.machine_file, "Machine file with [limits]")->required();
  check->add_flag("--proven", options.proven, "Exit code 1 unless every limit is proven to be met");
  sub.WithJson(check);
}

}  // namespace

void AddHistory(CLI::App& program, int& exit_code) {
  CLI::App* history = program.add_subcommand(
      "history", "The history of machines: keep, compare, follow and check campaigns");
  history->require_subcommand(1);
  history->footer(
      "Example: abbe history add measured --machine mill.toml\n"
      "         abbe history trend EYX --machine mill");
  Subcommands sub(*history, exit_code);
  AddKeeping(sub);
  AddJudging(sub);
}

}  // namespace abbe::apps
