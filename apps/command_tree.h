// The commands of the program and their options, read from their definitions: for manual pages and
// completion.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace abbe::apps {

struct CommandOption {
  std::vector<std::string> names;  // "--out", "-o"; empty: by position
  std::string value;               // "TEXT"; empty: none
  std::string what;
  std::vector<std::string> words;  // the values that it takes, if they are few
  std::string shown;               // "--out TEXT", or "map"
};

struct CommandNode {
  std::string path;  // "abbe rig record"
  std::string what, example;
  std::vector<CommandOption> options;
  std::vector<CommandNode> below;
};

CommandNode TreeOf(const CLI::App& program);

// Shell text for the completion of `abbe`: bash, zsh or fish. InputError for another shell.
std::string CompletionFor(const CommandNode& program, const std::string& shell);

// A page for man(1), in troff.
std::string ManPage(const CommandNode& command);

}  // namespace abbe::apps
