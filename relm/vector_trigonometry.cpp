#include "relm/vector_trigonometry.h"

#include <cmath>

namespace abbe::relm {

// Sines and cosines in loops of their own: as one loop the compiler would pair them into scalar
// sincos calls.
void SinesAndCosines(const double* __restrict__ angles, int count, double* __restrict__ sines,
                     double* __restrict__ cosines) {
  for (int i = 0; i < count; ++i) sines[i] = std::sin(angles[i]);
  for (int i = 0; i < count; ++i) cosines[i] = std::cos(angles[i]);
}

void ArcTangents(const double* __restrict__ y, const double* __restrict__ x, int count,
                 double* __restrict__ angles) {
  for (int i = 0; i < count; ++i) angles[i] = std::atan2(y[i], x[i]);
}

}  // namespace abbe::relm
