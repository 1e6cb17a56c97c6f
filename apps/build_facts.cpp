#include "apps/build_facts.h"

#include <fmt/format.h>

#include <Eigen/Core>

namespace abbe::apps {
namespace {

constexpr std::string_view kChecks =
#ifdef NDEBUG
    "assertions off";
#else
    "assertions on";
#endif

}  // namespace

std::string BuildFacts() {
  return fmt::format(
      "abbe {}\n"
      "compiler {}, C++ {}, {}, {}\n"
      "Eigen {}.{}.{}, fmt {}.{}.{}\n"
      "live page: {}; history: {}; certificates: {}; MPI: {}",
      ABBE_VERSION, __VERSION__, __cplusplus, ABBE_BUILD_TYPE, kChecks, EIGEN_WORLD_VERSION,
      EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION, FMT_VERSION / 10000, FMT_VERSION / 100 % 100,
      FMT_VERSION % 100, ABBE_WITH_LIVE ? "yes" : "no", ABBE_WITH_STORE ? "yes" : "no",
      ABBE_WITH_XML ? "yes" : "no", ABBE_WITH_MPI ? "yes" : "no");
}

}  // namespace abbe::apps
