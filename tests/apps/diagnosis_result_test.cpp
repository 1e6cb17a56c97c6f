// What a diagnosis leaves unexplained, as a person reads it: what is alike in one line.
#include "apps/diagnosis_result.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace abbe::apps {
namespace diagnosis_result_test {

using diagnosis::Leftover;
using testing::HasSubstr;
using testing::Not;

Leftover Left(const char* variable, const std::string& object, double amplitude, double p_value) {
  return {variable, object, amplitude, {"times the noise", 1.0}, p_value};
}

diagnosis::Diagnosis WithLeftovers() {
  diagnosis::Diagnosis diagnosis;
  diagnosis.verdict = diagnosis::Verdict::kUnexplained;
  for (int run = 1; run <= 9; ++run) {
    diagnosis.leftovers.push_back(
        Left(diagnosis::kScatter, "run_" + std::to_string(run), 0.5 + 0.1 * run, 1e-9 * run));
  }
  diagnosis.leftovers.push_back({"time", "probe_a", 0.35e-6, {"um", 1e-6}, 0.0});
  diagnosis.leftovers.push_back({"time", "ball_y", 0.27e-6, {"um", 1e-6}, 1e-20});
  diagnosis.leftovers.push_back({"time", "pivot_1", 40e-6, {"urad", 1e-6}, 1e-30});
  diagnosis.leftovers.push_back({"time", "pivot_1", 2e-6, {"urad", 1e-6}, 1e-15});
  diagnosis.leftovers.push_back(Left(diagnosis::kAtRest, "probe_c", 5.1, 1e-40));
  return diagnosis;
}

std::ptrdiff_t LinesOf(const std::string& text, const std::string& word) {
  std::ptrdiff_t lines = 0;
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++lines;
  return lines;
}

TEST(DiagnosisText, GathersWhatIsLeftAlike) {
  const std::string text = DiagnosisText(WithLeftovers(), {});
  EXPECT_EQ(LinesOf(text, "UNEXPLAINED"), 4) << text;
  EXPECT_THAT(text, HasSubstr("run_9, run_8, run_7, run_6 and 5 more scatter beyond their stated "
                              "noise by 0.6 to 1.4 times the noise (p at most 9e-09; --verbose: "
                              "each)"));
  // Other units are other things.
  EXPECT_THAT(text,
              HasSubstr("probe_a and ball_y vary with time by 0.27 to 0.35 um (p at most 1e-20)"));
  EXPECT_THAT(text, HasSubstr("pivot_1 varies with time by 2 to 40 urad"));
  EXPECT_THAT(text,
              HasSubstr("probe_c scatters where nothing moves by 5.1 times the noise (p 1e-40)"));
}

TEST(DiagnosisText, SaysEachOnRequest) {
  const std::string text = DiagnosisText(WithLeftovers(), {}, true);
  EXPECT_EQ(LinesOf(text, "UNEXPLAINED"), 14) << text;
  EXPECT_THAT(text,
              HasSubstr("run_3 scatters beyond its stated noise by 0.8 times the noise (p 3e-09)"));
  EXPECT_THAT(text, HasSubstr("probe_a varies with time by 0.35 um (p below 1e-300)"));
  EXPECT_THAT(text, Not(HasSubstr("--verbose")));
}

}  // namespace diagnosis_result_test
}  // namespace abbe::apps
