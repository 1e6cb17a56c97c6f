// Maps for tests: machines with random errors of every form, and a folder for their files.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "map/error_map.h"
#include "random/counter_random.h"

namespace abbe::map {

inline constexpr const char* kColumn = "[w X Y b Z t]";
inline constexpr const char* kBridge = "[w b Y X Z t]";

// 18 cubic B-splines of 8 coefficients over travels of 60 mm (2 um and 20 urad), squareness 30
// urad, and a covariance with correlations that is `relative` times as wide.
ErrorMap RandomMap(std::uint64_t seed, const char* chain = kColumn, double relative = 0.1);

// The same machine with a form of every kind in turn and travels of different length.
ErrorMap MapOfAllForms(std::uint64_t seed);

// A place in the travels.
Eigen::Vector3d RandomPlace(const ErrorMap& map, std::uint64_t seed, std::uint64_t index);

// Parameters drawn from the covariance of the map.
Eigen::VectorXd DrawParameters(const ErrorMap& map, std::uint64_t seed);

// The same map of a machine whose axes count otherwise.
inline ErrorMap Counted(const ErrorMap& map, const std::array<machine::Positive, 3>& positive) {
  machine::Chain chain = map.model().chain();
  chain.SetPositive(positive);
  machine::VolumetricModel model(chain, map.model().travels());
  for (int axis = 0; axis < machine::kAxes; ++axis) {
    for (int motion = 0; motion < machine::kMotions; ++motion) {
      const auto& function = map.model().Function(axis, motion);
      if (function.form() == nullptr) continue;
      model.SetForm(axis, motion, function.form());
      model.SetCoefficients(axis, motion, function.coefficients());
    }
  }
  model.SetSquareness(map.model().squareness());
  return {map.origin(), model, {}};
}

class Folder {
 public:
  Folder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "abbe-map-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no folder for the test");
    path_ = pattern;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::filesystem::path operator/(std::string_view name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

// The message of the failure of type F that `action` ends in.
template <typename F, typename Action>
std::string MessageOf(const Action& action) {
  try {
    action();
  } catch (const F& failure) {
    EXPECT_EQ(std::string_view(failure.what()).find('\n'), std::string_view::npos);
    return failure.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return {};
}

inline void ExpectHas(std::string_view text, std::string_view part) {
  EXPECT_NE(text.find(part), std::string_view::npos) << "`" << text << "` lacks `" << part << "`";
}

}  // namespace abbe::map
