// What follows of what a model is not sure of: what is refused, and what a U95 has to contain.
#include "simulation/doubt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "failure/failure.h"
#include "simulation/causes/registry.h"

namespace abbe::simulation {
namespace doubt_test {

using testing::AllOf;
using testing::HasSubstr;

ExtendedModel Model(const std::string& verdict, double probability) {
  ExtendedModel model;
  model.machine = "mill";
  model.verdict = verdict;
  model.causes.push_back(
      {&CauseNamed("backlash"), "X", Eigen::VectorXd::Constant(1, 6e-6), {}, {}});
  model.causes[0].probability = probability;
  return model;
}

ExtendedModel Unexplained() {
  ExtendedModel model = Model("unexplained", 1.0);
  model.unexplained = {{"probe_a", "time", 0.3, "um", 0.3e-6},
                       {"pivot_1", "temp_c", 10.0, "urad", 0.4e-6}};
  return model;
}

TEST(Doubt, RefusesACauseBesideWhatIsUnexplained) {
  ExtendedModel model = Unexplained();
  EXPECT_THAT([&] { RefuseUnexplained(model, "mill.toml", false); },
              testing::ThrowsMessage<InputError>(AllOf(
                  HasSubstr("mill.toml: "), HasSubstr("pivot_1 over temp_c, 10 urad, and 1 more"),
                  HasSubstr("diagnose again"), HasSubstr("--although-unexplained"))));
  model.next_runs = {"an hour later"};
  EXPECT_THAT([&] { RefuseUnexplained(model, "mill.toml", false); },
              testing::ThrowsMessage<InputError>(HasSubstr("\"an hour later\"")));
  EXPECT_NO_THROW(RefuseUnexplained(model, "mill.toml", true));
  for (const char* verdict : {"", "clean", "explained", "ambiguous"}) {
    EXPECT_NO_THROW(RefuseUnexplained(Model(verdict, 0.5), "mill.toml", false));
  }
}

TEST(Doubt, IsNotTakenAwayByAnotherVerdictInTheFile) {
  ExtendedModel model = Unexplained();
  model.verdict = "explained";
  EXPECT_THROW(RefuseUnexplained(model, "mill.toml", false), InputError);
  EXPECT_FALSE(IsCertain(model, model.causes[0]));
}

TEST(Doubt, IsOfCausesWithRivalsAndOfAllBesideWhatIsUnexplained) {
  const auto certain = [](const ExtendedModel& model) { return IsCertain(model, model.causes[0]); };
  EXPECT_TRUE(certain(Model("explained", 0.995)));
  EXPECT_TRUE(certain(Model("", 1.0)));
  EXPECT_FALSE(certain(Model("ambiguous", 0.98)));
  EXPECT_FALSE(certain(Unexplained()));
  ExtendedModel model = Model("ambiguous", 0.6);
  model.causes[0].rivals = {"servo-lag:X"};
  EXPECT_EQ(DoubtText(model, model.causes),
            "not certain: backlash:X (probability 0.600; or servo-lag:X)");
  model.causes[0].probability = 1.0;
  EXPECT_EQ(DoubtText(model, model.causes), "");
}

// 3, 4 and 12 make 13.
TEST(Doubt, AddsUpInSquares) {
  EXPECT_DOUBLE_EQ(UnexplainedInSpace(Unexplained()), 0.5e-6);
  EXPECT_DOUBLE_EQ(UnexplainedInSpace(Model("explained", 1.0)), 0.0);
  EXPECT_DOUBLE_EQ(WithDoubt(3.0, -4.0, 12.0), 13.0);
}

TEST(Doubt, StatesNoU95WhereNobodyKnowsTheSizeInSpace) {
  ExtendedModel model = Unexplained();
  model.unexplained[1].in_space.reset();
  EXPECT_THAT([&] { UnexplainedInSpace(model); },
              testing::ThrowsMessage<InputError>(HasSubstr("pivot_1")));
}

}  // namespace doubt_test
}  // namespace abbe::simulation
