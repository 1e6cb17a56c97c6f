// What a caller hears of steps, of steps in a step and of those that were not needed.
#include "failure/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <thread>
#include <tuple>
#include <vector>

namespace abbe {
namespace progress_test {

using testing::ElementsAre;
using testing::FieldsAre;

struct Heard {
  std::size_t done, total;
  std::string what;
};

ProgressTo::Function Into(std::vector<Heard>& heard) {
  return [&heard](std::size_t done, std::size_t total, const std::string& what) {
    heard.push_back({done, total, what});
  };
}

TEST(Progress, CountsStepsAndThoseWithinOne) {
  std::vector<Heard> heard;
  const ProgressTo caller(Into(heard));
  {
    Steps outer(2);
    outer.Begin("a");
    {
      Steps inner(3);
      inner.Begin("a 1");
      inner.Begin("a 2");  // the third is not needed
    }
    outer.Begin("b");
    outer.Begin("one more");
  }
  caller.End();
  EXPECT_THAT(heard, ElementsAre(FieldsAre(0, 2, "a"), FieldsAre(0, 5, "a 1"),
                                 FieldsAre(1, 5, "a 2"), FieldsAre(4, 5, "b"),
                                 FieldsAre(5, 6, "one more"), FieldsAre(6, 6, "done")));
}

TEST(Progress, IsThatOfTheLastCallerOnThisThread) {
  std::vector<Heard> first, second;
  const ProgressTo caller(Into(first));
  {
    const ProgressTo within(Into(second));
    Steps(1).Begin("within");
  }
  Steps(1).Begin("after");
  std::thread([] { Steps(1).Begin("another thread"); }).join();
  EXPECT_THAT(first, ElementsAre(FieldsAre(0, 1, "after")));
  EXPECT_THAT(second, ElementsAre(FieldsAre(0, 1, "within")));
}

TEST(Progress, ThatThrowsEndsTheComputation) {
  const ProgressTo caller(
      [](std::size_t, std::size_t, const std::string&) { throw std::runtime_error("enough"); });
  Steps steps(1);
  EXPECT_THROW(steps.Begin("a"), std::runtime_error);
}

TEST(Progress, IsNotNeeded) {
  Steps steps(1);
  steps.Begin("a");
  steps.Begin("b");
}

}  // namespace progress_test
}  // namespace abbe
