// The step of a digital reading: the largest that all readings are whole multiples of, apart.
//
//   ReadingStep readings;
//   readings.Add(12.30);  readings.Add(12.45);  readings.Add(12.35);  readings.Add(12.30);
//   readings.Step();                            // 0.05; 0: fewer than four different ones, or none
//   ReadingStep::Unseen(0.05, 0.01);            // variance that no repetition shows
//
// A reading that is rounded to steps q errs by what was cut off, the same each time at the same place
// where noise of standard deviation s moves it by less than a step:
//
//   u^2 = q^2 / 12 exp(-4 pi^2 s^2 / q^2)
//
// for one reading; noise of half a step averages it out. Where rounded readings have the variance v,
// s^2 = v - q^2 / 12, or 0.
// Units: those of the readings. Shapes: single readings, of which 3000 different ones are kept.
// Failure: none.
// Source: Widrow and Kollar, Quantization Noise (2008), 5 (first harmonic of the error) and 4
// (Sheppard's correction).
// Validity: readings that were written to a hundredth of their step or finer.
#pragma once

#include <set>

namespace abbe::estimation {

class ReadingStep {
 public:
  // In any order, all of one channel.
  void Add(double reading);
  // 0: none, or fewer than four different readings.
  double Step() const;

  // `variance`: of rounded readings, noise and all else that moves them between repetitions.
  static double Unseen(double step, double variance);

 private:
  std::set<double> different_;
};

}  // namespace abbe::estimation
