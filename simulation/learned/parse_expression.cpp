#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "failure/failure.h"
#include "simulation/learned/expression.h"
#include "simulation/variables.h"

namespace abbe::simulation {
namespace {

using Form = Atom::Form;

constexpr std::size_t kMostTerms = 3, kMostAtoms = 2;
constexpr double kMostParts = 200.0;  // of a B-spline

[[noreturn]] void Refuse(std::string_view part, std::string_view why) {
  throw InputError(fmt::format("\"{}\" {}", part, why));
}

// The parts between separators that stand outside of brackets.
std::vector<std::string_view> Parts(std::string_view text, std::string_view separator) {
  std::vector<std::string_view> parts;
  std::size_t first = 0;
  int depth = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    depth += text[at] == '(' ? 1 : text[at] == ')' ? -1 : 0;
    if (depth != 0 || !text.substr(at).starts_with(separator)) continue;
    parts.push_back(text.substr(first, at - first));
    first = at + separator.size();
    at = first - 1;
  }
  parts.push_back(text.substr(first));
  return parts;
}

double Number(std::string_view text, std::string_view of) {
  double number = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(number)) {
    Refuse(of, fmt::format("has \"{}\" where a number belongs", text));
  }
  return number;
}

std::string Variable(std::string_view name, std::string_view of) {
  if (!IsVariable(std::string(name))) {
    Refuse(of, fmt::format("is of \"{}\", which is no variable; docs/learned.md lists them", name));
  }
  return std::string(name);
}

// What stands between `begin` and `end`; empty: `text` is of another form.
std::optional<std::string_view> Between(std::string_view text, std::string_view begin,
                                        std::string_view end = ")") {
  if (!text.starts_with(begin) || !text.ends_with(end)) return {};
  if (text.size() <= begin.size() + end.size()) return {};
  return text.substr(begin.size(), text.size() - begin.size() - end.size());
}

// "v - 31.4", "v + 2", "v".
Atom Beyond(Form form, std::string_view inside, std::string_view text) {
  for (const auto& [sign, factor] : {std::pair{" - ", 1.0}, std::pair{" + ", -1.0}}) {
    const auto at = inside.rfind(sign);
    if (at == std::string_view::npos) continue;
    return {
        form, Variable(inside.substr(0, at), text), {factor * Number(inside.substr(at + 3), text)}};
  }
  return {form, Variable(inside, text), {0.0}};
}

// A variable, `separator`, and a number above zero.
Atom WithNumber(Form form, std::string_view inside, std::string_view separator,
                std::string_view text) {
  const auto at = inside.rfind(separator);
  if (at == std::string_view::npos) Refuse(text, "lacks its number");
  const double number = Number(inside.substr(at + separator.size()), text);
  if (!(number > 0.0)) Refuse(text, "needs a number above zero");
  return {form, Variable(inside.substr(0, at), text), {number}};
}

Atom Spline(std::string_view inside, std::string_view text) {
  const auto parts = Parts(inside, ", ");
  if (parts.size() != 4) Refuse(text, "needs a variable, its range and a number of parts");
  Atom atom{Form::kSpline, Variable(parts[0], text)};
  for (std::size_t i = 1; i < parts.size(); ++i) atom.numbers.push_back(Number(parts[i], text));
  const double count = atom.numbers[2];
  if (!(atom.numbers[1] > atom.numbers[0])) Refuse(text, "has an empty range");
  if (count < 1.0 || count > kMostParts || count != std::round(count)) {
    Refuse(text, fmt::format("needs a whole number of parts, 1 to {}", kMostParts));
  }
  return atom;
}

Atom ParseAtom(std::string_view text) {
  if (const auto in = Between(text, "sin(2 pi ")) return WithNumber(Form::kSine, *in, " / ", text);
  if (const auto in = Between(text, "cos(2 pi ")) {
    return WithNumber(Form::kCosine, *in, " / ", text);
  }
  if (const auto in = Between(text, "exp(-")) return WithNumber(Form::kDecay, *in, " / ", text);
  if (const auto in = Between(text, "lag(")) return WithNumber(Form::kLag, *in, ", ", text);
  if (const auto in = Between(text, "play(")) return WithNumber(Form::kPlay, *in, ", ", text);
  if (const auto in = Between(text, "step(")) return Beyond(Form::kStep, *in, text);
  if (const auto in = Between(text, "max(0, ")) return Beyond(Form::kKink, *in, text);
  if (const auto in = Between(text, "abs(")) return {Form::kAbsolute, Variable(*in, text)};
  if (const auto in = Between(text, "bspline(")) return Spline(*in, text);
  if (const auto in = Between(text, "sign(")) {
    Atom atom{Form::kSign, Variable(*in, text)};
    const bool is_axis = atom.variable.size() == 1;
    if (!is_axis && !atom.variable.starts_with("pivot_")) {
      Refuse(text, "is of no axis and no pivot");
    }
    return atom;
  }
  if (const auto in = Between(text, "", "^2")) return {Form::kSquare, Variable(*in, text)};
  return {Form::kLinear, Variable(text, text)};
}

Product ParseProduct(std::string_view text) {
  Product product;
  for (const std::string_view part : Parts(text, " * ")) product.push_back(ParseAtom(part));
  if (product.size() > kMostAtoms) Refuse(text, "is a product of more than two");
  for (const Atom& atom : product) {
    if (atom.form == Form::kSpline && product.size() > 1) {
      Refuse(text, "multiplies a B-spline, which stands alone");
    }
  }
  return product;
}

}  // namespace

Expression ParseExpression(const std::string& text) {
  Expression expression;
  for (const std::string_view part : Parts(text, " + ")) {
    expression.terms.push_back(ParseProduct(part));
  }
  if (expression.terms.size() > kMostTerms) Refuse(text, "has more than three terms");
  return expression;
}

}  // namespace abbe::simulation
