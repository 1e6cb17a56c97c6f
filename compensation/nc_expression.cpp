#include "compensation/nc_expression.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include "compensation/nc_block.h"
#include "failure/failure.h"

namespace abbe::compensation {
namespace {

constexpr int kDeepest = 64;
constexpr double kDegree = std::numbers::pi / 180.0, kEqual = 1e-6;

char UpperCase(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

bool IsLetter(char c) { return c >= 'A' && c <= 'Z'; }

bool IsDigit(char c) { return (c >= '0' && c <= '9') || c == '.'; }

struct Operator {
  std::string_view word;
  int strength;
};

// Longer words first: "**" before "*".
constexpr std::array<Operator, 15> kOperators{{{"**", 5},
                                               {"*", 4},
                                               {"/", 4},
                                               {"MOD", 4},
                                               {"+", 3},
                                               {"-", 3},
                                               {"EQ", 2},
                                               {"NE", 2},
                                               {"GT", 2},
                                               {"GE", 2},
                                               {"LT", 2},
                                               {"LE", 2},
                                               {"AND", 1},
                                               {"XOR", 1},
                                               {"OR", 1}}};

constexpr std::array<std::string_view, 14> kFunctions{"ABS",    "ACOS",  "ASIN", "ATAN", "COS",
                                                      "EXISTS", "EXP",   "FIX",  "FUP",  "LN",
                                                      "SIN",    "ROUND", "SQRT", "TAN"};

double Applied(std::string_view word, double a, double b) {
  const bool is_equal = std::abs(a - b) < kEqual;
  if (word == "**") return std::pow(a, b);
  if (word == "*") return a * b;
  if (word == "/") return a / b;
  if (word == "+") return a + b;
  if (word == "-") return a - b;
  if (word == "EQ") return is_equal;
  if (word == "NE") return !is_equal;
  if (word == "GT") return a > b;
  if (word == "GE") return is_equal || a >= b;
  if (word == "LT") return a < b;
  if (word == "LE") return is_equal || a <= b;
  if (word == "AND") return a != 0.0 && b != 0.0;
  if (word == "OR") return a != 0.0 || b != 0.0;
  if (word == "XOR") return (a != 0.0) != (b != 0.0);
  const double rest = std::fmod(a, b);  // MOD
  return rest < 0.0 ? rest + std::abs(b) : rest;
}

double FunctionOf(std::string_view name, double x) {
  if (name == "ABS") return std::abs(x);
  if (name == "ACOS") return std::acos(x) / kDegree;
  if (name == "ASIN") return std::asin(x) / kDegree;
  if (name == "COS") return std::cos(x * kDegree);
  if (name == "EXP") return std::exp(x);
  if (name == "FIX") return std::floor(x);
  if (name == "FUP") return std::ceil(x);
  if (name == "LN") return x > 0.0 ? std::log(x) : kRuntime;
  if (name == "ROUND") return std::trunc(x + (x < 0.0 ? -0.5 : 0.5));
  if (name == "SIN") return std::sin(x * kDegree);
  if (name == "SQRT") return std::sqrt(x);
  return std::tan(x * kDegree);
}

}  // namespace

// Counts how deep brackets and signs are nested, so that the stack is not used up.
struct NcCursor::Deeper {
  explicit Deeper(NcCursor& at) : cursor(at) {
    if (++cursor.depth_ > kDeepest) {
      cursor.Refuse(fmt::format("brackets and signs nested more than {} deep", kDeepest));
    }
  }
  ~Deeper() { --cursor.depth_; }
  NcCursor& cursor;
};

void NcCursor::Refuse(const std::string& what) const { RefuseLine(line_number_, what); }

char NcCursor::Peek() {
  while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\r')) {
    ++at_;
  }
  return at_ < text_.size() ? UpperCase(text_[at_]) : '\0';
}

bool NcCursor::Take(char c) {
  if (Peek() != c) return false;
  ++at_;
  return true;
}

bool NcCursor::TakeWord(std::string_view word) {
  const std::size_t start = at_;
  for (const char c : word) {  // blanks may stand within a word
    if (Take(c)) continue;
    at_ = start;
    return false;
  }
  return true;
}

bool NcCursor::IsAtValue() {
  const std::size_t start = at_;
  while (Peek() == '+' || Peek() == '-') ++at_;
  const char first = Peek();
  bool is_value = IsDigit(first) || first == '#' || first == '[';
  for (const std::string_view name : kFunctions) {
    if (!is_value && TakeWord(name)) is_value = Peek() == '[';
  }
  at_ = start;
  return is_value;
}

NcCursor::Parameter NcCursor::ParameterName() {
  if (Peek() != '<') {
    const double value = Value();
    constexpr double kLargest = 1e6;
    if (std::isnan(value)) Refuse("the number of a parameter is known only at the control");
    if (!(std::abs(value) < kLargest) || std::abs(value - std::round(value)) > kEqual) {
      Refuse(fmt::format("{:.9g} is no number of a parameter", value));
    }
    return {"", static_cast<int>(std::lround(value))};
  }
  const std::size_t end = text_.find('>', at_);
  if (end == std::string_view::npos) Refuse("the name of a parameter does not end with >");
  Parameter parameter;
  for (const char c : text_.substr(at_ + 1, end - at_ - 1)) {
    if (c == ' ' || c == '\t') continue;
    parameter.name += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  if (parameter.name.empty()) Refuse("a parameter without a name");
  at_ = end + 1;
  return parameter;
}

double NcCursor::Read(const Parameter& parameter) const {
  if (!parameter.name.empty()) {
    const auto value = parameters_.Named(parameter.name);
    if (!value) {
      Refuse(fmt::format("#<{}> has no value here; set it before it is used", parameter.name));
    }
    return *value;
  }
  try {
    return parameters_.Number(parameter.number);
  } catch (const InputError& failure) {
    Refuse(failure.what());
  }
}

double NcCursor::Number() {
  double value = 0.0;
  const char* const begin = text_.data() + at_;
  const auto [end, error] =
      std::from_chars(begin, text_.data() + text_.size(), value, std::chars_format::fixed);
  if (error != std::errc()) Refuse(fmt::format("\"{}\" is not a number", Rest().substr(0, 10)));
  at_ += end - begin;
  return value;
}

double NcCursor::Value() {
  const Deeper deeper(*this);
  const char first = Peek();
  if (IsDigit(first)) return Number();
  if (first == '[') return Expression();
  if (Take('#')) return Read(ParameterName());
  if (Take('+')) return Value();
  if (Take('-')) return -Value();
  return Function();
}

double NcCursor::Expression() {
  Take('[');
  const double value = Operand(1);
  if (!Take(']')) Refuse("an expression without ]");
  return value;
}

// The operator here if it is at least as strong as `weakest`; -1 and nothing taken otherwise.
int NcCursor::TakeOperator(int weakest) {
  const std::size_t start = at_;
  for (std::size_t i = 0; i < kOperators.size(); ++i) {
    if (!TakeWord(kOperators[i].word)) continue;
    if (kOperators[i].strength >= weakest) return static_cast<int>(i);
    at_ = start;
    return -1;
  }
  return -1;
}

double NcCursor::Operand(int weakest) {
  double left = Value();
  for (int index = TakeOperator(weakest); index >= 0; index = TakeOperator(weakest)) {
    const Operator& by = kOperators[index];
    constexpr int kStrongest = 5;
    const double right = by.strength == kStrongest ? Value() : Operand(by.strength + 1);
    if (std::isnan(left) || std::isnan(right)) {
      left = kRuntime;
      continue;
    }
    const double result = Applied(by.word, left, right);
    if (!std::isfinite(result)) {
      Refuse(fmt::format("{:.9g} {} {:.9g} has no value", left, by.word, right));
    }
    left = result;
  }
  return left;
}

double NcCursor::Function() {
  for (const std::string_view name : kFunctions) {
    if (!TakeWord(name)) continue;
    if (Peek() != '[') Refuse(fmt::format("{} without [", name));
    if (name == "EXISTS") {
      Take('[');
      if (!Take('#')) Refuse("EXISTS takes a named parameter");
      const Parameter parameter = ParameterName();
      if (parameter.name.empty() || !Take(']')) Refuse("EXISTS takes one named parameter");
      return parameters_.Exists(parameter.name);
    }
    const double x = Expression();
    double value;
    if (name == "ATAN") {
      if (!Take('/') || Peek() != '[') Refuse("ATAN takes [y]/[x]");
      const double other = Expression();
      if (std::isnan(other)) return kRuntime;
      value = std::atan2(x, other) / kDegree;
    } else {
      value = FunctionOf(name, x);
    }
    if (std::isnan(x)) return kRuntime;
    if (!std::isfinite(value)) Refuse(fmt::format("{}[{:.9g}] has no value", name, x));
    return value;
  }
  if (IsLetter(Peek()) || Peek() != '\0') {
    Refuse(fmt::format("\"{}\" is not a value", Rest().substr(0, 10)));
  }
  Refuse("a value is missing");
}

}  // namespace abbe::compensation
