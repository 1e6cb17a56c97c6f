#include "study/deal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <stdexcept>

namespace abbe::study {
namespace {

using testing::HasSubstr;

class Squares : public Study {
 public:
  Row World(std::uint64_t seed) const override {
    if (seed == 13) throw std::runtime_error("no square of 13");
    return {{"square", seed * seed}};
  }
};

Dealing Of(std::uint64_t count, int threads) {
  Dealing dealing{.seeds = {}, .threads = threads};
  for (std::uint64_t seed = 1; seed <= count; ++seed) dealing.seeds.push_back(seed);
  return dealing;
}

TEST(Deal, GivesEachSeedToOneThread) {
  Ranks alone;
  std::map<std::uint64_t, Row> kept;
  Deal(Squares(), Of(500, 4), alone, [&](std::uint64_t seed, const Row& row) {
    EXPECT_FALSE(kept.contains(seed));
    kept[seed] = row;
  });
  ASSERT_EQ(kept.size(), 500);
  EXPECT_EQ(kept[20].at("square"), 400);
  EXPECT_EQ(kept[13].at("failed"), "no square of 13");
}

TEST(Deal, EndsWhenItIsTold) {
  Ranks alone;
  std::atomic<bool> ended = false;
  int kept = 0;
  Dealing dealing = Of(500, 1);
  dealing.ended = &ended;
  Deal(Squares(), dealing, alone, [&](std::uint64_t, const Row&) { ended = ++kept == 7; });
  EXPECT_EQ(kept, 7);
}

TEST(Deal, EndsWhereARowCannotBeKept) {
  Ranks alone;
  int kept = 0;
  const auto keep = [&](std::uint64_t, const Row&) {
    if (++kept == 3) throw std::runtime_error("disk full");
  };
  EXPECT_THAT([&] { Deal(Squares(), Of(500, 2), alone, keep); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("disk full")));
  EXPECT_EQ(kept, 3);
}

}  // namespace
}  // namespace abbe::study
