#include "standards/circle_signatures.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace abbe::standards {
namespace {

constexpr double kPi = std::numbers::pi;

double Sign(double value) { return value > 0.0 ? 1.0 : value < 0.0 ? -1.0 : 0.0; }

// The angle since the last reversal of the axis whose extremes are at `extreme` and `extreme` + pi.
double SinceReversal(const CirclePoint& at, double extreme) {
  const double turned = at.sense * (at.angle - extreme);
  return turned - kPi * std::floor(turned / kPi);
}

// From -1, where the axis has just turned, to 1, where its backlash is taken up.
double ShareTakenUp(const CirclePoint& at, double extreme, TakenUp how, double way) {
  if (how == TakenUp::kAtOnce || !(way > 0.0)) return 1.0;
  const double gone = at.radius * (1.0 - std::cos(SinceReversal(at, extreme)));
  if (how == TakenUp::kWithPlay) return 2.0 * std::min(1.0, gone / way) - 1.0;
  return 1.0 - 2.0 * std::exp(-gone / way);
}

double Spike(const CirclePoint& at, double extreme, const SpikeForm& form, std::size_t axis) {
  const double widths = SinceReversal(at, extreme) / form.WidthAt(at.feed, axis);
  return form.sharp ? std::exp(-widths) : widths * std::exp(1.0 - widths);
}

// Cosine and sine of the cyclic error of an axis at `position`; `along` projects it on the radius.
void AddCyclic(char axis, double pitch, const std::function<double(const CirclePoint&)>& position,
               double (*along)(double), std::vector<Signature>& signatures) {
  for (const auto& [name, wave] :
       {std::pair<const char*, double (*)(double)>{"cyclic_cos", std::cos},
        std::pair<const char*, double (*)(double)>{"cyclic_sin", std::sin}}) {
    signatures.push_back(
        {name, std::string(1, axis), "m", 20e-6, [=, wave = wave](const CirclePoint& at) {
           return wave(2.0 * kPi * position(at) / pitch) * along(at.angle);
         }});
  }
}

}  // namespace

std::vector<Signature> CircleSignatures(const SignatureOptions& options) {
  const std::string x(1, options.first), y(1, options.second), plane = x + y;
  using At = const CirclePoint&;
  constexpr double kAny = std::numeric_limits<double>::infinity();
  std::vector<Signature> table{
      {"centre", x, "m", kAny, [](At at) { return std::cos(at.angle); }},
      {"centre", y, "m", kAny, [](At at) { return std::sin(at.angle); }},
      {"scale", x, "1", 200e-6,
       [](At at) { return at.radius * std::cos(at.angle) * std::cos(at.angle); }},
      {"scale", y, "1", 200e-6,
       [](At at) { return at.radius * std::sin(at.angle) * std::sin(at.angle); }},
      {"squareness", plane, "rad", 1e-3,
       [](At at) { return -at.radius / 2.0 * std::sin(2.0 * at.angle); }},
      {"servo_mismatch", plane, "s", 10e-3,
       [](At at) { return at.sense * at.feed / 2.0 * std::sin(2.0 * at.angle); }},
      {"servo_lag_squared", plane, "s2", 1e-3,
       [](At at) { return -at.feed * at.feed / (2.0 * at.radius); }},
      {"backlash", x, "m", 50e-6,
       [how = options.taken_up, way = options.way[0]](At at) {
         return at.sense / 2.0 * std::cos(at.angle) * Sign(std::sin(at.angle)) *
                ShareTakenUp(at, 0.0, how, way);
       }},
      {"backlash", y, "m", 50e-6,
       [how = options.taken_up, way = options.way[1]](At at) {
         return -at.sense / 2.0 * std::sin(at.angle) * Sign(std::cos(at.angle)) *
                ShareTakenUp(at, kPi / 2.0, how, way);
       }},
      {"straightness", "E" + y + x, "m", 50e-6,
       [](At at) { return (std::sin(at.angle) + std::sin(3.0 * at.angle)) / 4.0; }, "-E" + y + y},
      {"straightness", "E" + x + y, "m", 50e-6,
       [](At at) { return (std::cos(at.angle) - std::cos(3.0 * at.angle)) / 4.0; }, "-E" + x + x},
      {"reversal_spike", x, "m", 20e-6,
       [form = options.spike](At at) { return Spike(at, 0.0, form, 0); }},
      {"reversal_spike", y, "m", 20e-6,
       [form = options.spike](At at) { return Spike(at, kPi / 2.0, form, 1); }},
  };
  if (const auto pitch = options.pitch.find(options.first); pitch != options.pitch.end()) {
    const auto position = [c = options.first_centre](At at) {
      return c + at.radius * std::cos(at.angle);
    };
    AddCyclic(options.first, pitch->second, position, std::cos, table);
  }
  if (const auto pitch = options.pitch.find(options.second); pitch != options.pitch.end()) {
    const auto position = [c = options.second_centre](At at) {
      return c + at.radius * std::sin(at.angle);
    };
    AddCyclic(options.second, pitch->second, position, std::sin, table);
  }
  return table;
}

}  // namespace abbe::standards
