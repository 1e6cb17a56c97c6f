// How many worlds of a study met something, and what was asked.
//
//   Rate named;
//   named.Add(true);
//   named.Text();  // "1 of 1"
//
// Low() and High() are the ends of the 99 % interval of Clopper and Pearson (Biometrika 26 (1934)):
// a share that was asked for is refuted when it lies outside.
// Units: none. Failure: none. Validity: worlds drawn independently.
#pragma once

#include <string>

namespace abbe::study {

struct Rate {
  int worlds = 0, met = 0;

  void Add(bool is_met) {
    ++worlds;
    met += is_met ? 1 : 0;
  }
  void Add(const Rate& other) {
    worlds += other.worlds;
    met += other.met;
  }
  double Low() const;
  double High() const;
  std::string Text() const;
};

// A rate and what is asked of it: at least, and at most, this share.
struct Bound {
  std::string what;
  Rate rate;
  double least = 0.0, most = 1.0;

  bool IsRefuted() const { return rate.worlds > 0 && (rate.High() < least || rate.Low() > most); }
};

}  // namespace abbe::study
