// abbe certificate: a map or a calibration as a digital calibration certificate (DCC) or in QIF.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>

#include "apps/certificate_result.h"
#include "apps/command.h"
#include "apps/commands.h"
#include "apps/result_file.h"
#include "certificate/dcc.h"
#include "certificate/qif.h"

namespace abbe::apps {
namespace {

struct CertificateCommand {
  CertificateSources sources;
  std::string format = "dcc";
  std::filesystem::path out;
  int points = 13;
  bool quiet = false;
};

// The text of the document, which reads back the same.
std::string DocumentText(const certificate::Certificate& made, const CertificateCommand& options) {
  const std::string name = options.out.string();
  const bool is_qif = options.format == "qif";
  const std::string text = is_qif ? certificate::QifText(made) : certificate::DccText(made);
  const bool same = is_qif ? certificate::ReadQif(text, name) == certificate::KeptByQif(made)
                           : certificate::ReadDcc(text, name) == made;
  if (!same)
    throw NumericalError(name + ": does not read back as it was written; nothing is saved");
  return text;
}

void Print(const certificate::Certificate& made, const CertificateCommand& options) {
  fmt::print("{}: {}, number {}\n", options.out.string(), made.title, made.administration.number);
  for (const auto& each : made.conformities) {
    fmt::print("{:<16}{:<28}{:>9.3f} +- {:.3f} {}, limit {:g}\n", each.status, each.name,
               each.value, each.U95, each.unit, each.limit);
  }
  for (const std::string& each : made.doubts) fmt::print("NO CONFORMITY IS STATED: {}\n", each);
  for (const std::string& each : made.remarks) fmt::print("remark: {}\n", each);
}

int WriteCertificate(const CertificateCommand& options) {
  const auto sense =
      options.format == "qif" ? certificate::Sense::kTool : certificate::Sense::kCarriages;
  const auto made = MakeCertificate(options.sources, sense, options.points);
  WriteText(DocumentText(made, options), options.out);
  if (!options.quiet) Print(made, options);
  return kDone;
}

}  // namespace

void AddCertificate(CLI::App& program, int& exit_code) {
  auto options = std::make_shared<CertificateCommand>();
  CLI::App* command = program.add_subcommand(
      "certificate", "A calibration certificate of a map or of the linkage (DCC, QIF)");
  CertificateSources& sources = options->sources;
  command->add_option("of", sources.of, "Error map or calibration of the linkage (TOML)")
      ->required();
  command->add_option("--result", sources.result, "The --json of the command that wrote it")
      ->required();
  command->add_option("--machine", sources.machine, "Machine file, with limits")->required();
  command->add_option("--data", sources.data,
                      "File with the table [certificate] (default: the machine file)");
  command->add_option("--diagnosis", sources.diagnosis,
                      "The --json of abbe diagnose of the same recordings");
  command->add_option("--format", options->format, "dcc (DCC 3.2 with D-SI) or qif (QIF 3.0)")
      ->check(CLI::IsMember({"dcc", "qif"}));
  command->add_option("--points", options->points, "Positions along each axis")
      ->check(CLI::Range(2, 1000));
  command->add_option("-o,--out", options->out, "The certificate (XML)")->required();
  command->add_flag("--quiet", options->quiet, "Print nothing but warnings");
  command->footer(
      "Example: abbe certificate map.toml --result fuse.json --machine mill.toml -o map.dcc.xml");
  command->callback([options, &exit_code] { exit_code = WriteCertificate(*options); });
}

}  // namespace abbe::apps
