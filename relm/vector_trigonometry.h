// Sines, cosines and arc tangents of many numbers at once, from the C library.
//
// Its own source file so that it alone is compiled for the vector functions of glibc (libmvec),
// which are right to 4 units in the last place; elsewhere the same loops call the scalar ones.
// All inputs must be finite.
#pragma once

namespace abbe::relm {

void SinesAndCosines(const double* angles, int count, double* sines, double* cosines);
void ArcTangents(const double* y, const double* x, int count, double* angles);

}  // namespace abbe::relm
