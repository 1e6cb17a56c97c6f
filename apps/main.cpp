// The program: adds the subcommands, runs the one that was asked for, maps failures to exit codes.
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <string>
#include <vector>

#include "apps/commands.h"
#include "failure/failure.h"
#include "settings/nearest_word.h"

namespace {

// A word in the place of the subcommand that is none.
void RefuseUnknown(const CLI::App& program, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  std::vector<std::string> known;
  for (const CLI::App* command : program.get_subcommands({})) known.push_back(command->get_name());
  if (std::find(known.begin(), known.end(), argv[1]) != known.end()) return;
  throw abbe::InputError(fmt::format("{}: there is no such command; did you mean \"abbe {}\"?",
                                     argv[1], abbe::settings::NearestWord(argv[1], known)));
}

// CLI11's message for a bad option, with the command that it was given to.
std::string UsageOf(const CLI::App& program, const CLI::ParseError& error) {
  std::string command = "abbe";
  for (const CLI::App* given : program.get_subcommands()) command += " " + given->get_name();
  const std::string message = error.what();
  return fmt::format("{}; see {} --help", message.substr(0, message.find('\n')), command);
}

int Report(const std::exception& failure, int exit_code) {
  fmt::print(stderr, "abbe: {}\n", failure.what());
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace abbe::apps;
  CLI::App program(
      "abbe measures the geometric errors of a machine tool, maps them and explains them.");
  program.name("abbe");
  program.set_version_flag("--version", ABBE_VERSION);
  program.require_subcommand(1);
  program.get_formatter()->column_width(34);
  int exit_code = kDone;
  for (const AddCommand add : kCommands) add(program, exit_code);
  try {
    RefuseUnknown(program, argc, argv);
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program.exit(error);
    return Report(abbe::InputError(UsageOf(program, error)), kBadInput);
  } catch (const abbe::InputError& failure) {
    return Report(failure, kBadInput);
  } catch (const abbe::DeviceError& failure) {
    return Report(failure, kDeviceFailed);
  } catch (const abbe::NumericalError& failure) {
    return Report(failure, kNumericsFailed);
  } catch (const std::exception& failure) {
    return Report(failure, kNumericsFailed);
  }
  return exit_code;
}
