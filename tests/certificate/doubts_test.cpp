// What in a result forbids a statement of conformity.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "certificate/doubts_of_result.h"

namespace abbe::certificate {
namespace doubts_test {

TEST(Doubts, AreThoseOfTheResult) {
  const auto doubts = [](const char* json) {
    return DoubtsOfResult(nlohmann::ordered_json::parse(json));
  };
  EXPECT_TRUE(
      doubts(R"({"contradictions": [], "misfits": [], "residuals_over_noise": 1.1})").empty());
  EXPECT_TRUE(doubts(R"({"verdict": "explained", "unexplained": []})").empty());
  EXPECT_TRUE(doubts("[]").empty());
  const auto one = doubts(R"({"contradictions": ["a.csv"], "widened": 2.5})");
  ASSERT_EQ(one.size(), 1u);
  EXPECT_NE(one[0].find("a.csv disagrees"), std::string::npos);
  EXPECT_NE(one[0].find("2.5 times"), std::string::npos);
  EXPECT_EQ(doubts(R"({"misfits": ["a.csv", "b.csv"]})").size(), 2u);
  const auto scatter = doubts(R"({"scatter": [{"run": "a.csv", "axis": "Z", "sd_um": 2.9}]})");
  ASSERT_EQ(scatter.size(), 1u);
  EXPECT_EQ(scatter[0].rfind("Scatter: the places of a.csv scatter along Z", 0), 0u) << scatter[0];
  EXPECT_EQ(doubts(R"({"residuals_over_noise": 3.5})").size(), 1u);
  EXPECT_EQ(doubts(R"({"verdict": "ambiguous"})").size(), 1u);
  EXPECT_EQ(doubts(R"({"causes_taken_out": {"doubt": ["x"]}})").size(), 1u);
  EXPECT_EQ(doubts(R"({"verdict": "unexplained", "unexplained": [
                      {"variable": "time", "object": "X", "amplitude": 1.0, "unit": "um"}]})")
                .size(),
            2u);
}

}  // namespace doubts_test
}  // namespace abbe::certificate
