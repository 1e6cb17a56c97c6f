#include "study/rate.h"

#include <fmt/format.h>

#include <boost/math/distributions/binomial.hpp>

namespace abbe::study {
namespace {

using Binomial = boost::math::binomial_distribution<>;
constexpr double kTail = 0.005;

}  // namespace

double Rate::Low() const {
  return met == 0 ? 0.0 : Binomial::find_lower_bound_on_p(worlds, met, kTail);
}

double Rate::High() const {
  return met == worlds ? 1.0 : Binomial::find_upper_bound_on_p(worlds, met, kTail);
}

std::string Rate::Text() const { return fmt::format("{} of {}", met, worlds); }

}  // namespace abbe::study
