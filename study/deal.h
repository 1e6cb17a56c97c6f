// Dynamic scheduling of worlds over threads of this process, or processes that mpirun started.
//
//   Ranks ranks;  // MPI where mpirun started this program
//   Deal(study, {.seeds = {1, 2, 3}}, ranks,
//        [&](std::uint64_t seed, const Row& row) { store.Add(seed, row); });
//
// Number 0 deals the seeds in their order, one at a time, works some out itself and keeps all rows;
// the others ask it for a seed and send back the row. What a seed gives does not depend on who had
// it. A process that is lost ends all of them (mpirun sees to it); the store has what was kept.
// Failure: what `keep` throws; a world that fails is a row (study.h).
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <vector>

#include "study/ranks.h"
#include "study/study.h"

namespace abbe::study {

// Called for one row at a time.
using Keep = std::function<void(std::uint64_t seed, const Row& row)>;

struct Dealing {
  std::vector<std::uint64_t> seeds;          // of interest on number 0 only
  int threads = 0;                           // of number 0; 0: all processors, one under mpirun
  const std::atomic<bool>* ended = nullptr;  // true: no further seed is dealt
};

// On every process. Returns when no seed is left.
void Deal(const Study& study, const Dealing& dealing, Ranks& ranks, const Keep& keep);

// {"failed": what it throws} where World throws.
Row RowOf(const Study& study, std::uint64_t seed);

}  // namespace abbe::study
