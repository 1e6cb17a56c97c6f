#include "machine/chain.h"

#include <fmt/format.h>

#include <cctype>
#include <sstream>
#include <vector>

#include "failure/failure.h"

namespace abbe::machine {
namespace {

constexpr std::string_view kForm =
    "write it as \"[w X Y b Z t]\": w, the axes that move the workpiece, b, the axes that move the "
    "tool, t";

InputError Refuse(std::string_view text, std::string_view reason) {
  return InputError(fmt::format("the chain \"{}\" {}; {}", text, reason, kForm));
}

// The letters of the chain without brackets, blanks and axes in parentheses.
std::string Letters(std::string_view text) {
  std::string letters;
  bool in_parentheses = false;
  for (const char letter : text) {
    if (std::isspace(static_cast<unsigned char>(letter)) != 0) continue;
    if (letter == '(' || letter == ')') {
      if (in_parentheses == (letter == '(')) throw Refuse(text, "has unpaired parentheses");
      in_parentheses = !in_parentheses;
    } else if (!in_parentheses) {
      letters += letter;
    }
  }
  if (in_parentheses) throw Refuse(text, "has unpaired parentheses");
  if (letters.size() < 2 || letters.front() != '[' || letters.back() != ']') {
    throw Refuse(text, "is not in brackets");
  }
  return letters.substr(1, letters.size() - 2);
}

}  // namespace

Chain Chain::Parse(std::string_view text) {
  const std::string letters = Letters(text);
  if (letters.empty() || letters.front() != 'w') throw Refuse(text, "does not begin with w");
  if (letters.back() != 't') throw Refuse(text, "does not end with t");
  Chain chain;
  bool past_bed = false;
  bool after_axis = false;
  for (const char letter : letters.substr(1, letters.size() - 2)) {
    if (letter == '\'') {
      if (!after_axis) throw Refuse(text, "has a prime that follows no axis");
      if (past_bed) throw Refuse(text, "has a prime on an axis that moves the tool");
      after_axis = false;
    } else if (letter == 'b') {
      if (past_bed) throw Refuse(text, "has more than one b");
      past_bed = true;
      after_axis = false;
    } else if (letter >= 'X' && letter <= 'Z') {
      const std::string seen = chain.workpiece_axes_ + chain.tool_axes_;
      if (seen.find(letter) != std::string::npos) {
        throw Refuse(text, fmt::format("names the axis {} twice", letter));
      }
      (past_bed ? chain.tool_axes_ : chain.workpiece_axes_) += letter;
      after_axis = true;
    } else if (letter >= 'A' && letter <= 'C') {
      throw Refuse(text,
                   fmt::format("has the rotary axis {}, but only X, Y and Z can be measured: put "
                               "it in parentheses and hold it still",
                               letter));
    } else {
      throw Refuse(text, fmt::format("has an unknown letter '{}'", letter));
    }
  }
  if (!past_bed) throw Refuse(text, "has no b");
  if (chain.workpiece_axes_.empty() && chain.tool_axes_.empty()) {
    throw Refuse(text, "names none of the axes X, Y and Z");
  }
  return chain;
}

bool Chain::CarriesTarget(char axis) const {
  if (axis >= 'X' && axis <= 'Z') return workpiece_axes_.find(axis) != std::string::npos;
  throw InputError(
      fmt::format("'{}' is not an axis of the chain {}; name X, Y or Z", axis, Text()));
}

std::optional<Positive> PositiveNamed(std::string_view word) {
  if (word == "tool") return Positive::kTool;
  if (word == "carriage") return Positive::kCarriage;
  return std::nullopt;
}

void Chain::SetPositive(const std::array<Positive, 3>& positive) {
  for (std::size_t i = 0; i < positive.size(); ++i) {
    const bool against = positive[i] == Positive::kTool && CarriesTarget("XYZ"[i]);
    carriage_sense_[i] = against ? -1.0 : 1.0;
  }
}

void Chain::ReadPositive(std::string_view words, std::string_view how) {
  std::vector<Positive> read;
  std::istringstream text{std::string(words)};
  for (std::string word; text >> word;) {
    const std::optional<Positive> positive = PositiveNamed(word);
    if (!positive) {
      throw InputError(fmt::format(
          "\"{}\" is not a way to count an axis: write \"tool\" or \"carriage\"", word));
    }
    read.push_back(*positive);
  }
  if (read.empty() && workpiece_axes_.empty()) return;
  if (read.empty()) {
    throw InputError(fmt::format(
        "it is not stated which way {} counts, which carries the workpiece; {}: tool, where the "
        "number rises as the tool goes towards + against the workpiece (ISO 841), or carriage, "
        "where it rises as the workpiece goes towards +",
        workpiece_axes_.front(), how));
  }
  if (read.size() != 1 && read.size() != 3) {
    throw InputError(
        fmt::format("\"{}\" must be one word for all axes or one each for X, Y and Z: tool or "
                    "carriage",
                    words));
  }
  SetPositive({read.front(), read.size() == 1 ? read.front() : read[1], read.back()});
}

std::string Chain::PositiveText() const {
  std::string text;
  for (const char axis : std::string_view("XYZ")) {
    if (!text.empty()) text += ' ';
    text += ToolSense(axis) > 0.0 ? "tool" : "carriage";
  }
  return text;
}

double Chain::CarriageSense(char axis) const { return carriage_sense_[axis - 'X']; }

double Chain::ToolSense(char axis) const {
  return CarriesTarget(axis) ? -CarriageSense(axis) : CarriageSense(axis);
}

Eigen::Vector3d Chain::ToolSenses() const {
  return {ToolSense('X'), ToolSense('Y'), ToolSense('Z')};
}

std::string Chain::Movers(char axis) const {
  const std::string from_bed = CarriesTarget(axis)
                                   ? std::string(workpiece_axes_.rbegin(), workpiece_axes_.rend())
                                   : tool_axes_;
  return from_bed.substr(0, from_bed.find(axis) + 1);
}

std::string Chain::Text() const {
  std::string text = "[w";
  for (const char axis : workpiece_axes_) text += fmt::format(" {}", axis);
  text += " b";
  for (const char axis : tool_axes_) text += fmt::format(" {}", axis);
  return text + " t]";
}

}  // namespace abbe::machine
