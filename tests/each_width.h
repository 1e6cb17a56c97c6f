// Runs a test once with each width of vectors that the processor has.
#pragma once

#include <gtest/gtest.h>
#include <hwy/targets.h>

namespace abbe::test {

// Calls test() for each target that Highway made and that runs here; the kernels that it calls are
// held to that target.
template <typename Test>
void OnEachWidth(const Test& test) {
  for (const auto target : hwy::SupportedAndGeneratedTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    test();
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace abbe::test
