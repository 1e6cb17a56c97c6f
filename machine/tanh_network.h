// The neural network of Ha and Khanh as a form of an error function: one hidden layer of tanh and a
// linear output.
//
//   as printed     f(x) = sum over q of w_q tanh(gain v_q x)
//   with bias      f(x) = w_0 + sum over q of w_q tanh(gain v_q x + b_q)
//
// Coefficients: as printed [v_1 w_1 v_2 w_2 ...], with bias [v_1 b_1 w_1 v_2 ... w_0]; v and b are
// dimensionless, w has the unit of the function. gain, 1/m: the constant c of the paper; 2 over the
// travel keeps v near 1.
// Units: x in m. Shapes: coefficients 2 q x 1 as printed, (3 q + 1) x 1 with bias, of q neurons.
// Failure: InputError for fewer than one neuron or a gain not above 0.
// Source: Ha and Khanh, "An application of neural network in calibration of coordinate measuring
// machines" (2011), equations 22 and 23, with one input in place of three: an error function
// depends on its own axis.
// Validity: as printed it is odd in x and cannot represent the even part of an error. The integrals
// of the gauge are exact to rounding while |gain v| times the travel stays below about 300.
#pragma once

#include "machine/standard_forms.h"

namespace abbe::machine {

enum class NetworkBias { kAsPrinted, kWithBias };

// As printed, all coefficients 0 is a stationary point of a fit: start from others.
SharedForm MakeTanhNetwork(int neurons, double gain, NetworkBias bias);

}  // namespace abbe::machine
