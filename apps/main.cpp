// The program: adds the subcommands, runs the requested one, maps failures to exit codes.
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include "apps/build_facts.h"
#include "apps/commands.h"
#include "apps/output_guard.h"
#include "failure/failure.h"
#include "settings/nearest_word.h"

namespace {

// InputError for an unknown subcommand.
void RefuseUnknown(const CLI::App& program, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  std::vector<std::string> known;
  for (const CLI::App* command : program.get_subcommands({})) known.push_back(command->get_name());
  if (std::find(known.begin(), known.end(), argv[1]) != known.end()) return;
  throw abbe::InputError(fmt::format("{}: there is no such command; did you mean \"abbe {}\"?",
                                     argv[1], abbe::settings::NearestWord(argv[1], known)));
}

// The innermost subcommand on the command line, as typed.
struct ActiveCommand {
  const CLI::App* command;
  std::string typed;
};

ActiveCommand CommandOf(const CLI::App& program) {
  ActiveCommand active{&program, "abbe"};
  while (!active.command->get_subcommands().empty()) {
    active.command = active.command->get_subcommands().front();
    active.typed += " " + active.command->get_name();
  }
  return active;
}

// The message for the first unknown option, with the nearest known one; empty if there is none.
std::string UnknownOption(const ActiveCommand& active, int argc, char** argv) {
  std::vector<std::string> known{"help"};
  std::vector<const CLI::App*> groups = active.command->get_subcommands(
      [](const CLI::App* group) { return group->get_name().empty(); });
  groups.push_back(active.command);
  for (const CLI::App* group : groups) {
    for (const CLI::Option* option : group->get_options()) {
      for (const std::string& name : option->get_lnames()) known.push_back(name);
    }
  }
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (!word.starts_with("--") || word.size() == 2) continue;
    const std::string name = word.substr(2, word.find('=') - 2);
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string nearest = abbe::settings::NearestWord(name, known);
    // --help alone is near to nothing but itself, and is named anyway.
    const std::string meant = nearest == "help" ? "" : fmt::format("; did you mean --{}?", nearest);
    return fmt::format("--{}: {} has no such option{}", name, active.typed, meant);
  }
  return "";
}

// The error in the command line: an unknown option, or the message of CLI11.
std::string UsageOf(const CLI::App& program, const CLI::ParseError& error, int argc, char** argv) {
  const ActiveCommand active = CommandOf(program);
  std::string wrong = UnknownOption(active, argc, argv);
  if (wrong.empty()) wrong = std::string(error.what());
  return fmt::format("{}; see {} --help", wrong.substr(0, wrong.find('\n')), active.typed);
}

// What a message quotes of a file may be meant for a terminal.
int Report(const std::exception& failure, int exit_code) {
  std::string text = failure.what();
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  fmt::print(stderr, "abbe: {}\n", text);
  return exit_code;
}

// Out of memory: std::bad_alloc, or std::length_error of a container.
int ReportMemory() {
  return Report(abbe::InputError("out of memory: the request is larger than the memory of this "
                                 "computer; ask for fewer points, draws or rows"),
                abbe::apps::kBadInput);
}

// 3 if standard output could not be written, else `exit_code`.
int FlushOutput(int exit_code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return exit_code;
  const std::string why = std::strerror(errno);
  return Report(abbe::DeviceError(fmt::format(
                    "standard output: cannot be written: {}; make room and try again", why)),
                abbe::apps::kDeviceFailed);
}

}  // namespace

int main(int argc, char** argv) {
  using namespace abbe::apps;
  CLI::App program(
      "abbe measures the geometric errors of a machine tool, maps them and explains them.");
  program.name("abbe");
  program.set_version_flag("--version", BuildFacts());
  program.require_subcommand(1);
  program.get_formatter()->column_width(34);
  program.footer("Example: abbe init");
  int exit_code = kDone;
  for (const AddCommand add : kCommands) add(program, exit_code);
  GuardOutputs(program);
  std::signal(SIGXFSZ, SIG_IGN);  // a file size limit is reported like a full disk
  try {
    RefuseUnknown(program, argc, argv);
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return program.exit(error);
    return Report(abbe::InputError(UsageOf(program, error, argc, argv)), kBadInput);
  } catch (const abbe::InputError& failure) {
    return Report(failure, kBadInput);
  } catch (const abbe::DeviceError& failure) {
    return Report(failure, kDeviceFailed);
  } catch (const abbe::NumericalError& failure) {
    return Report(failure, kNumericsFailed);
  } catch (const std::bad_alloc&) {
    return ReportMemory();
  } catch (const std::length_error&) {
    return ReportMemory();
  } catch (const std::filesystem::filesystem_error& failure) {
    return Report(failure, kBadInput);
  } catch (const std::system_error& failure) {
    return Report(failure, kDeviceFailed);
  } catch (const std::exception& failure) {
    return Report(failure, kNumericsFailed);
  }
  return FlushOutput(exit_code);
}
