// The program: adds the subcommands, runs the one that was asked for, maps failures to exit codes.
#include <fmt/format.h>

#include <exception>

#include "apps/commands.h"
#include "failure/failure.h"

namespace {

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
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? kDone : kBadInput;
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
