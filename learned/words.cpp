#include "learned/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "simulation/stage_channel.h"
#include "simulation/variables.h"
#include "standards/coverage.h"

namespace abbe::learned {
namespace {

using simulation::Atom;
using simulation::LearnedTerm;
using Form = Atom::Form;

struct Maker {
  std::string_view form, motion, reading, encoder, tip;
};

// What makes such things on machines, by form and stage.
constexpr std::array kMakers = {
    Maker{"step",
          "a joint of two scales or guideways, a rail end under a carriage, a clamp that lets go",
          "a loose contact, a range switch of the amplifier, a touched cable",
          "a scratch or dirt on the graduation, a joint of the disc, lost counts",
          "the ball settling in its seat"},
    Maker{"kink", "a guideway that is held up to there only, a stop or cover that begins to press",
          "the end of the linear range of the probe", "a bearing that begins to bind",
          "a magnet that begins to lift"},
    Maker{"wave", "screw, rack or scale pitch, rolling elements of a guideway",
          "mains or a neighbour's oscillator, a ripple of the target",
          "interpolation of the encoder, a gear tooth, an oval race", "an oval ball"},
    Maker{"decay", "settling after a move or a change of load, oil film that forms",
          "an amplifier that warms up", "grease that spreads", "a seat that settles"},
    Maker{"position", "a bent guideway or scale, weight that travels",
          "a stray field along the way", "an eccentric disc, an arm that bends",
          "a cap that is out of line"},
    Maker{"product", "weight of one axis that bends the guideway of another, a twisted bed",
          "tilt of the target with its place", "gravity on a turning arm",
          "a cap force that turns with the arm"},
    Maker{"speed",
          "following error, friction, an oil film that lifts the carriage, centrifugal force",
          "a low-pass filter in the amplifier", "a late or filtered encoder reading",
          "drag of the ball in its cap"},
    Maker{"direction", "play, wind-up of a screw, friction of covers and hoses",
          "a cable that is dragged along",
          "play in a joint, a hysteresis of the encoder's coupling",
          "friction of the ball in its cap"},
    Maker{"temperature", "heat in spindle, drive or coolant, a column that bends with the room",
          "temperature of probe and amplifier", "temperature of a link or its encoder",
          "growth of the ball's stem"},
    Maker{"time", "warming up, a foundation that creeps", "drift of the amplifier",
          "creep of a joint", "a seat that creeps"},
    Maker{"own column", "what that column measures: load, torque, humidity, coolant", "the same",
          "the same", "the same"},
};

bool IsOf(const std::string& variable, std::string_view beginning) {
  return variable.starts_with(beginning);
}

// The row of the table.
std::string_view FormOf(const LearnedTerm& term) {
  const auto& product = term.expression.terms.front();
  if (product.size() > 1 && product[0].form != Form::kSign && product[1].form != Form::kSign) {
    return "product";
  }
  if (product.size() > 1) return "direction";
  const Atom& atom = product.front();
  const std::string& v = atom.variable;
  switch (atom.form) {
    case Form::kStep:
      return "step";
    case Form::kKink:
      return "kink";
    case Form::kSine:
      return "wave";
    case Form::kDecay:
      return "decay";
    case Form::kSign:
    case Form::kPlay:
      return "direction";
    default:
      break;
  }
  if (IsOf(v, "column ")) return "own column";
  if (v.find("temp_") != std::string::npos) return "temperature";
  if (IsOf(v, "time")) return "time";
  if (v == "feed" || IsOf(v, "speed of ")) return "speed";
  if (IsOf(v, "way of ")) return "direction";
  return "position";
}

std::string_view AtStage(const Maker& maker, const std::string& stage) {
  if (stage == "reading") return maker.reading;
  if (stage == "encoder") return maker.encoder;
  return stage == "tip" ? maker.tip : maker.motion;
}

std::string Unit(const std::string& variable) { return simulation::UnitOf(variable).name; }

// A value and its U95, as many digits as that has.
std::string Sized(double value, double u95) {
  if (!(u95 > 0.0)) return fmt::format("{:.4g}", value);
  const double digits = std::ceil(std::log10(std::abs(value) / u95)) + 2.0;
  const int shown = static_cast<int>(std::clamp(digits, 2.0, 8.0));
  return fmt::format("{:.{}g} +- {:.2g}", value, shown, u95);
}

std::string Of(const std::string& variable) {
  return variable.size() == 1 ? std::string(1, static_cast<char>(std::toupper(variable[0])))
                              : variable;
}

struct Size {
  double value, u95;
};

// A coefficient in the unit of its channel, times `factor`.
Size SizeOf(const LearnedTerm& term, double factor) {
  const double unit = simulation::ChannelNamed(term.object).value().unit.si;
  const double u =
      term.covariance.size() > 0 ? std::sqrt(std::max(0.0, term.covariance(0, 0))) : 0.0;
  return {factor * term.coefficients[0] / unit, std::abs(factor) * standards::kCoverage * u / unit};
}

std::string At(const LearnedTerm& term, const Atom& atom) {
  const double u95 = term.u95_of_numbers.empty() ? 0.0 : term.u95_of_numbers.front();
  return Sized(atom.numbers.front(), u95) + " " + Unit(atom.variable);
}

std::string PerUnit(const std::string& variable, const std::string& unit) {
  return Unit(variable).empty() ? unit : unit + "/" + Unit(variable);
}

Size AmplitudeOf(const LearnedTerm& term) {
  const double unit = simulation::ChannelNamed(term.object).value().unit.si;
  const double amplitude = term.coefficients.norm();
  double u = 0.0;
  if (term.covariance.size() > 0 && amplitude > 0.0) {
    const Eigen::VectorXd along = term.coefficients / amplitude;
    u = std::sqrt(std::max(0.0, along.dot(term.covariance * along)));
  }
  return {amplitude / unit, standards::kCoverage * u / unit};
}

std::string SplineWords(const LearnedTerm& term, const Atom& atom) {
  const double unit = simulation::ChannelNamed(term.object).value().unit.si;
  const double span = term.coefficients.maxCoeff() - term.coefficients.minCoeff();
  return fmt::format(
      "{} is a smooth function of {} over {:.4g} to {:.4g} {}, spanning {:.3g} {}; "
      "no expression of the grammar says it",
      term.object, Of(atom.variable), atom.numbers[0], atom.numbers[1], Unit(atom.variable),
      span / unit, simulation::ChannelNamed(term.object).value().unit.name);
}

std::string OneAtom(const LearnedTerm& term, const Atom& atom, const std::string& unit) {
  const std::string& object = term.object;
  const std::string v = Of(atom.variable);
  const auto [value, u95] = SizeOf(term, 1.0);
  const std::string size = Sized(value, u95);
  switch (atom.form) {
    case Form::kLinear:
      return fmt::format("{} changes by {} {} with {}", object, size, PerUnit(atom.variable, unit),
                         v);
    case Form::kSquare:
      return fmt::format("{} changes by {} {} times the square of {} in {}", object, size, unit, v,
                         Unit(atom.variable));
    case Form::kAbsolute:
      return fmt::format("{} changes by {} {} with the size of {}, whichever its sign", object,
                         size, PerUnit(atom.variable, unit), v);
    case Form::kStep:
      return fmt::format("{} steps by {} {} at {} = {}", object, size, unit, v, At(term, atom));
    case Form::kKink:
      return fmt::format("{} changes by {} {} with {} beyond {}", object, size,
                         PerUnit(atom.variable, unit), v, At(term, atom));
    case Form::kSine:
    case Form::kCosine: {
      const Size amplitude = AmplitudeOf(term);
      return fmt::format("{} waves by {} {} over {}, a period of {}", object,
                         Sized(amplitude.value, amplitude.u95), unit, v, At(term, atom));
    }
    case Form::kDecay:
      return fmt::format("{} begins {} {} off and fades with {}, constant {}", object, size, unit,
                         v, At(term, atom));
    case Form::kLag:
      return fmt::format(
          "{} follows {} by {} {}, {} s late", object, v, size, PerUnit(atom.variable, unit),
          Sized(atom.numbers[0], term.u95_of_numbers.empty() ? 0.0 : term.u95_of_numbers.front()));
    case Form::kPlay:
      return fmt::format("{} has a play over {} of {}, which makes {} {} from end to end", object,
                         v, At(term, atom), size, unit);
    case Form::kSign: {
      const auto twice = SizeOf(term, 2.0);
      return fmt::format("{} differs by {} {} between both directions of {}", object,
                         Sized(twice.value, twice.u95), unit, v);
    }
    case Form::kSpline:
      return SplineWords(term, atom);
  }
  return "";
}

}  // namespace

std::string InWords(const LearnedTerm& term) {
  const auto& product = term.expression.terms.front();
  const std::string unit = simulation::ChannelNamed(term.object).value().unit.name;
  if (product.size() == 1) return OneAtom(term, product.front(), unit);
  const auto [value, u95] = SizeOf(term, 1.0);
  std::string units;
  for (const Atom& atom : product) {
    if (atom.form == Form::kSign || Unit(atom.variable).empty()) continue;
    units += (units.empty() ? "" : " times ") + Of(atom.variable) + " in " + Unit(atom.variable);
  }
  return fmt::format("{} changes by {} {} times {}{}", term.object, Sized(value, u95), unit,
                     simulation::TextOf(product), units.empty() ? "" : " (" + units + ")");
}

std::string SuggestionFor(const LearnedTerm& term) {
  const auto maker = std::ranges::find(kMakers, FormOf(term), &Maker::form);
  if (maker == kMakers.end() || term.expression.terms.front().front().form == Form::kSpline) {
    return "";
  }
  return std::string(AtStage(*maker, simulation::StageName(term.object)));
}

std::string MakersTable() {
  std::string table =
      "| form | error motion of an axis | reading of a probe | angle of a pivot | place of the ball "
      "|\n|---|---|---|---|---|\n";
  for (const Maker& maker : kMakers) {
    table += fmt::format("| {} | {} | {} | {} | {} |\n", maker.form, maker.motion, maker.reading,
                         maker.encoder, maker.tip);
  }
  return table;
}

}  // namespace abbe::learned
