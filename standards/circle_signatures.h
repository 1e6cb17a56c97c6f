// Signatures of error causes in the radius of a circle: the columns of the joint fit.
//
// A circle of radius R in the plane of axes (first, second), t the angle from first towards second,
// d = +1 counter-clockwise (t grows) and -1 clockwise, v the feed. The radial deviation for an
// amount 1 of each cause:
//
//   centre first, second      cos t, sin t                    set-up, not an error of the machine
//   scale first, second       R cos^2 t, R sin^2 t            relative; same in both senses
//   squareness                -(R/2) sin 2t                   rad; > 0: more than 90 degrees from
//                                                             +first to +second
//   servo mismatch            d (v/2) sin 2t                  s; > 0: first lags more than second
//   servo lag squared         -v^2 / (2R)                     s^2; common first-order lag
//   backlash first            d/2 cos t sgn(sin t)            m; lost at each reversal
//   backlash second           -d/2 sin t sgn(cos t)           both times what is taken up at the way
//                                                             s = R (1 - cos) since the axis turned,
//                                                             1 at once, 2 min(1, s / way) - 1 with
//                                                             play, 1 - 2 exp(-s / way) by wind-up
//   straightness of first     (sin t + sin 3t) / 4            m; bow h (first/R)^2 into second
//   straightness of second    (cos t - cos 3t) / 4            m; bow h (second/R)^2 into first
//   cyclic, pitch p           cos, sin(2 pi position/p) times cos t (first) or sin t (second)
//   reversal spike            (s/w) exp(1 - s/w)              m; s is the angle since the axis last
//             or, sharp,      exp(-s/w)                       turned, w the width, the same at all
//                                                             feeds or in proportion; outwards
//
// A radius does not tell a bow of the first axis into the second from one of the second along
// itself with the other sign: k (second/R)^2 along second is k/4 (3 sin t - sin 3t), and sin t is
// the centre. `alike` names it.
// Units: SI. Source: derived from position errors dx, dy by radial = dx cos t + dy sin t, to first
// order. A bow written as h(1 - (x/R)^2) has the same signature, up to `centre`. Validity: errors
// small compared with R. Caution: unequal backlash leaks d 0.424 (b_first - b_second) into sin 2t,
// with the sense behaviour of servo mismatch; fit all causes together, both senses and two feeds at
// least. Adding a cause: one line of the table in circle_signatures.cpp.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace abbe::standards {

struct CirclePoint {
  double angle;   // rad, t
  double sense;   // d
  double radius;  // m, R
  double feed;    // m/s, v
};

struct Signature {
  std::string cause;   // "backlash"
  std::string object;  // an axis "X", a pair "XY", an error function "EYX"
  std::string unit;    // SI, of the amount: "m", "rad", "s", "s2", "1"
  double usual;        // a large amount for a machine tool; infinite: no bound
  std::function<double(const CirclePoint&)> radial;  // m, for an amount 1
  std::string alike = {};  // "-EYY": the same amount of it with the other sign has this signature
};

// How backlash is taken up after a reversal.
enum class TakenUp : unsigned char { kAtOnce, kWithPlay, kByWindUp };

struct SpikeForm {
  std::array<double, 2> width = {0.07, 0.07};  // rad, w of the first and the second axis
  bool sharp = false;                          // there at once, and then falling
  double at_feed = 0.0;  // m/s: there the width is this, else in proportion; 0: the same at all

  double WidthAt(double feed, std::size_t axis) const {
    return at_feed > 0.0 ? width[axis] * feed / at_feed : width[axis];
  }
  bool operator==(const SpikeForm&) const = default;
};

struct SignatureOptions {
  char first = 'X', second = 'Y';
  double first_centre = 0.0, second_centre = 0.0;  // m: axis positions of the circle's centre
  std::map<char, double> pitch;  // m: of cyclic errors, by axis; absent: not fitted
  SpikeForm spike = {};
  TakenUp taken_up = TakenUp::kAtOnce;
  std::array<double, 2> way = {0.0, 0.0};  // m: of the first and the second axis; 0: at once
};

std::vector<Signature> CircleSignatures(const SignatureOptions& options);

}  // namespace abbe::standards
