// The result of a sweep while it goes on: reduced again from the file as stations come, for the
// page.
//
// Until the first pass is done its forward half is reduced, later all whole passes. A reduction
// begins when the last one is twenty times its own duration ago, so that it takes a twentieth of a
// processor at most; a thread of its own does it.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>
#include <thread>

#include "apps/live_view.h"
#include "hal/sweep_plan.h"
#include "probes/sweep_reduction.h"

namespace abbe::apps {

class GrowingSweep {
 public:
  // Nothing happens without a view. The rest must outlive it.
  GrowingSweep(LiveView* view, const hal::SweepPlan& plan, const probes::SweepSetup& setup,
               std::filesystem::path recording);
  ~GrowingSweep();
  GrowingSweep(const GrowingSweep&) = delete;
  GrowingSweep& operator=(const GrowingSweep&) = delete;

  void VisitsDone(std::size_t visits) { visits_ = visits; }
  void Finish();

 private:
  void Run(const std::stop_token& stop);
  void Reduce(std::size_t visits);

  LiveView* view_;
  const hal::SweepPlan& plan_;
  const probes::SweepSetup& setup_;
  const std::filesystem::path recording_;
  std::atomic<std::size_t> visits_ = 0;
  std::jthread thread_;
};

}  // namespace abbe::apps
