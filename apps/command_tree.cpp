#include "apps/command_tree.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>

#include "failure/failure.h"

namespace abbe::apps {
namespace {

// The words of CLI11's description "TEXT:{X,Y,Z}" of a value.
std::vector<std::string> WordsOf(const std::string& type) {
  const std::size_t open = type.find('{'), close = type.find('}');
  std::vector<std::string> words;
  if (open == std::string::npos || close == std::string::npos) return words;
  std::string_view rest = std::string_view(type).substr(open + 1, close - open - 1);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find(','), rest.size());
    words.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return words;
}

CommandOption OptionOf(const CLI::Option& option) {
  CommandOption result;
  for (const std::string& name : option.get_lnames()) result.names.push_back("--" + name);
  for (const std::string& name : option.get_snames()) result.names.push_back("-" + name);
  const std::string type = option.get_type_name();
  const bool takes_value = option.get_items_expected_max() > 0;
  if (takes_value) result.value = type.substr(0, type.find_first_of(":= "));
  result.words = WordsOf(type);
  result.what = option.get_description();
  result.shown =
      result.names.empty() ? option.get_name() : fmt::format("{}", fmt::join(result.names, ", "));
  if (!result.names.empty() && takes_value)
    result.shown += " " + (result.value.empty() ? "VALUE" : result.value);
  return result;
}

void AddOptions(const CLI::App& command, std::vector<CommandOption>& options) {
  for (const CLI::Option* option : command.get_options()) options.push_back(OptionOf(*option));
  for (const CLI::App* group :
       command.get_subcommands([](const CLI::App* below) { return below->get_name().empty(); })) {
    AddOptions(*group, options);
  }
}

CommandNode NodeOf(const CLI::App& command, const std::string& path) {
  CommandNode node{path, command.get_description(), command.get_footer(), {}, {}};
  AddOptions(command, node.options);
  for (const CLI::App* below :
       command.get_subcommands([](const CLI::App* each) { return !each->get_name().empty(); })) {
    node.below.push_back(NodeOf(*below, path + " " + below->get_name()));
  }
  return node;
}

std::string_view LastWordOf(const CommandNode& node) {
  return std::string_view(node.path).substr(node.path.rfind(' ') + 1);
}

std::vector<std::string> WordsAt(const CommandNode& node) {
  std::vector<std::string> words;
  for (const CommandNode& below : node.below) words.emplace_back(LastWordOf(below));
  for (const CommandOption& option : node.options) {
    const std::vector<std::string>& offered = option.names.empty() ? option.words : option.names;
    words.insert(words.end(), offered.begin(), offered.end());
  }
  return words;
}

// Lines of a case by the path, and by the option before the word.
void AddCases(const CommandNode& node, std::string& words, std::string& values) {
  words += fmt::format("    '{}') words='{}' ;;\n", node.path, fmt::join(WordsAt(node), " "));
  for (const CommandOption& option : node.options) {
    if (option.words.empty()) continue;
    for (const std::string& name : option.names) {
      values += fmt::format("    '{} {}') words='{}' ;;\n", node.path, name,
                            fmt::join(option.words, " "));
    }
  }
  for (const CommandNode& below : node.below) AddCases(below, words, values);
}

void Paths(const CommandNode& node, std::vector<std::string>& paths) {
  paths.push_back(node.path);
  for (const CommandNode& below : node.below) Paths(below, paths);
}

std::string BashCompletion(const CommandNode& program) {
  std::string words, values;
  AddCases(program, words, values);
  std::vector<std::string> paths;
  Paths(program, paths);
  return fmt::format(
      "# Completion of abbe in bash, written by: abbe completion bash\n"
      "_abbe() {{\n"
      "  local path=abbe words='' i current=${{COMP_WORDS[COMP_CWORD]}}\n"
      "  local paths='|{}|'\n"
      "  for ((i = 1; i < COMP_CWORD; i++)); do\n"
      "    [[ $paths == *\"|$path ${{COMP_WORDS[i]}}|\"* ]] && path=\"$path ${{COMP_WORDS[i]}}\"\n"
      "  done\n"
      "  case \"$path ${{COMP_WORDS[COMP_CWORD-1]}}\" in\n{}"
      "    *) case \"$path\" in\n{}    esac ;;\n"
      "  esac\n"
      "  COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
      "}}\n"
      "complete -o default -F _abbe abbe\n",
      fmt::join(paths, "|"), values, words);
}

std::string FishQuoted(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'' || c == '\\') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return "'" + out + "'";
}

void AddFish(const CommandNode& node, const std::string& condition, std::string& out) {
  for (const CommandNode& below : node.below) {
    out += fmt::format("complete -c abbe -f -n {} -a {} -d {}\n", FishQuoted(condition),
                       LastWordOf(below), FishQuoted(below.what));
  }
  for (const CommandOption& option : node.options) {
    if (option.names.empty() && !option.words.empty()) {
      out += fmt::format("complete -c abbe -f -n {} -a '{}' -d {}\n", FishQuoted(condition),
                         fmt::join(option.words, " "), FishQuoted(option.what));
    }
    for (const std::string& name : option.names) {
      const bool is_long = name.starts_with("--");
      out += fmt::format(
          "complete -c abbe -n {} {} {}{}{} -d {}\n", FishQuoted(condition), is_long ? "-l" : "-s",
          name.substr(is_long ? 2 : 1), option.value.empty() ? "" : " -r",
          option.words.empty() ? "" : fmt::format(" -f -a '{}'", fmt::join(option.words, " ")),
          FishQuoted(option.what));
    }
  }
  for (const CommandNode& below : node.below) {
    std::string seen = fmt::format("__fish_seen_subcommand_from {}", LastWordOf(below));
    for (const CommandNode& other : node.below) {  // "rig record" is not "record"
      const bool has_it = std::ranges::any_of(
          other.below, [&](const CommandNode& n) { return LastWordOf(n) == LastWordOf(below); });
      if (has_it)
        seen += fmt::format("; and not __fish_seen_subcommand_from {}", LastWordOf(other));
    }
    AddFish(below, condition == "__fish_use_subcommand" ? seen : condition + "; and " + seen, out);
  }
}

// troff: a backslash and a dot or a quote at the start of a line mean something else.
std::string Troff(std::string_view text) {
  std::string out;
  bool is_start = true;
  for (const char c : text) {
    if (is_start && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') out += "\\e";
    if (c == '-') out += "\\-";
    if (c != '\\' && c != '-') out += c;
    is_start = c == '\n';
  }
  return out;
}

}  // namespace

CommandNode TreeOf(const CLI::App& program) { return NodeOf(program, program.get_name()); }

std::string CompletionFor(const CommandNode& program, const std::string& shell) {
  if (shell == "bash") return BashCompletion(program);
  if (shell == "zsh") {
    return "#compdef abbe\n# Completion of abbe in zsh, by that of bash, written by: abbe completion zsh\n"
           "autoload -U +X bashcompinit && bashcompinit\n" +
           BashCompletion(program) +
           // zsh reads this file when the first completion is asked for, which is answered too.
           "_bash_complete -o default -F _abbe\n";
  }
  if (shell != "fish") {
    throw InputError(fmt::format("{}: no shell that is known here; bash, zsh or fish", shell));
  }
  std::string out = "# Completion of abbe in fish, written by: abbe completion fish\n";
  AddFish(program, "__fish_use_subcommand", out);
  return out;
}

std::string ManPage(const CommandNode& command) {
  std::string name = command.path;
  std::replace(name.begin(), name.end(), ' ', '-');
  std::string upper = name;
  std::transform(upper.begin(), upper.end(), upper.begin(), [](char c) {
    return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  });
  std::string out = fmt::format(
      ".TH {} 1 \"\" \"abbe {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n.B {}\n[options]\n",
      Troff(upper), ABBE_VERSION, Troff(name), Troff(command.what), Troff(command.path));
  if (!command.below.empty()) {
    out += ".SH COMMANDS\n";
    for (const CommandNode& below : command.below) {
      out += fmt::format(".TP\n.B {}\n{}\n", Troff(below.path), Troff(below.what));
    }
  }
  out += ".SH OPTIONS\n";
  for (const CommandOption& option : command.options) {
    out += fmt::format(
        ".TP\n.B {}\n{}{}\n", Troff(option.shown), Troff(option.what),
        option.words.empty() ? "" : Troff(fmt::format(" ({})", fmt::join(option.words, ", "))));
  }
  if (!command.example.empty()) {
    out += fmt::format(".SH EXAMPLES\n.nf\n{}\n.fi\n", Troff(command.example));
  }
  out +=
      ".SH EXIT STATUS\n0 done; 1 a requirement is not met; 2 wrong input; 3 a device or the system failed; 4 "
      "numerical failure.\n.SH SEE ALSO\n.BR abbe (1), the manual in docs/\n";
  return out;
}

}  // namespace abbe::apps
