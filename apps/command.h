// The interface of a subcommand: one file apps/NAME.cpp that defines AddNAME, one declaration and
// one line of the table in commands.h. AddNAME adds the subcommand with its options and an example
// in its footer, and gives it a callback that parses, calls the library, prints and sets the exit
// code; failures are thrown and mapped to exit codes in main.cpp.
//
//   struct ConvertOptions {
//     std::filesystem::path from, to;
//   };
//   int Convert(const ConvertOptions& options) { return kDone; }
//   void AddConvert(CLI::App& program, int& exit_code) {
//     auto options = std::make_shared<ConvertOptions>();
//     CLI::App* command = program.add_subcommand("convert", "CSV <-> HDF5, losslessly");
//     command->add_option("from", options->from)->required();
//     command->footer("Example: abbe convert sweep_X.csv sweep_X.h5");
//     command->callback([options, &exit_code] { exit_code = Convert(*options); });
//   }
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace abbe::apps {

// Exit codes: done; done, but a requirement of the user is not met; bad input; device; numerics.
inline constexpr int kDone = 0;
inline constexpr int kRequirementNotMet = 1;
inline constexpr int kBadInput = 2;
inline constexpr int kDeviceFailed = 3;
inline constexpr int kNumericsFailed = 4;

using AddCommand = void (*)(CLI::App& program, int& exit_code);

// A check of an option that takes a number above 0, or not below; that of CLI11 names the largest
// number there is, digit by digit.
inline CLI::Validator PositiveNumber() {
  return {[](std::string& word) {
            double number = 0.0;
            const bool is_one = CLI::detail::lexical_cast(word, number) && number > 0.0;
            return is_one ? std::string() : word + " is no number above 0";
          },
          "POSITIVE"};
}
inline CLI::Validator NonNegativeNumber() {
  return {[](std::string& word) {
            double number = 0.0;
            const bool is_one = CLI::detail::lexical_cast(word, number) && number >= 0.0;
            return is_one ? std::string() : word + " is no number, or one below 0";
          },
          "NONNEGATIVE"};
}

}  // namespace abbe::apps
