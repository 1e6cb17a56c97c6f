// The temperature of what follows another with a lag of first order: lag dy/dt = T - y.
//
//   lagged = LagAfter(lagged, from, to, seconds, lag);    // T goes straight from `from` to `to`
//
//   y(t) = T(t) - s lag + (y(0) - T(0) + s lag) exp(-t / lag)        s = (T(t) - T(0)) / t
//
// Units: temperatures in one unit, times in s. Failure: none. A lag or a time of 0 follows at once
// or not at all.
// Source: closed form of the linear equation for a straight line.
// Validity: T is a straight line between its readings.
#pragma once

namespace abbe::track {

double LagAfter(double lagged, double from, double to, double seconds, double lag);

}  // namespace abbe::track
