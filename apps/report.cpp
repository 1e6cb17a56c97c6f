// abbe report: one HTML page of an output folder.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "apps/command.h"
#include "apps/commands.h"
#include "apps/result_file.h"
#include "report/print_pdf.h"
#include "report/report_page.h"

namespace abbe::apps {
namespace {

struct ReportOptions {
  std::filesystem::path folder;
  std::filesystem::path out, pdf;
};

int MakeReport(const ReportOptions& options) {
  const auto page = options.out.empty() ? options.folder / "report.html" : options.out;
  const report::Report report = report::ComposeReport(options.folder);
  WriteText(report.page, page);
  for (const std::string& note : report.notes) fmt::print(stderr, "abbe: {}\n", note);
  fmt::print("{}\n", page.string());
  if (!options.pdf.empty()) {
    WriteText(report::PrintPdf(page), options.pdf);
    fmt::print("{}\n", options.pdf.string());
  }
  return kDone;
}

}  // namespace

void AddReport(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<ReportOptions>();
  CLI::App* command =
      program.add_subcommand("report", "One HTML page of all results in an output folder");
  command->add_option("folder", options->folder, "Folder with the results (*.json)")->required();
  command->add_option("--out", options->out, "The page (default: report.html in the folder)");
  command->add_option("--pdf", options->pdf, "Print the page too, by Chromium");
  command->footer("Example: abbe report out --out sweep.html --pdf sweep.pdf");
  command->callback([options, &exit_code] { exit_code = MakeReport(*options); });
}

}  // namespace abbe::apps
