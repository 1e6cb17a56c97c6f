// How the caller of a long computation ends it: between their steps the long ones ask here.
//
//   AskBetweenSteps(ask);      // void ask(): an exception of it ends the work
//
// What the asked function throws ends the computation and reaches the caller, as any other exception
// that is not a NumericalError. One function for the whole process; at first none is asked.
// Failure: what the function throws.
// Validity: asked by fits, joint maps, searches for causes and Monte Carlo draws, up to a second
// apart on large campaigns; on the thread of the caller or on one that works for it.
#pragma once

#include <atomic>

namespace abbe {

using Interruption = void (*)();

inline std::atomic<Interruption> interruption_of_process{nullptr};

// Null: none is asked.
inline void AskBetweenSteps(Interruption ask) { interruption_of_process = ask; }

// A place between two steps.
inline void MayBeInterrupted() {
  if (const Interruption ask = interruption_of_process.load(std::memory_order_relaxed)) ask();
}

}  // namespace abbe
