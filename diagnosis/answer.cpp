#include "diagnosis/answer.h"

#include <cmath>
#include <utility>

namespace abbe::diagnosis {
namespace {

constexpr double kPerName = 100.0;  // candidates, about
const double kPriorOfMember = std::log(kPresent / kPerName);

}  // namespace

Answer Ask(std::shared_ptr<const Campaign> campaign, const std::shared_ptr<Search>& search,
           double prior) {
  Answer answer{std::move(campaign), search, search->Run(), prior};
  answer.diagnosis.campaign = answer.campaign;
  const Fit& fit = search->fit();
  answer.worth = prior + fit.log_likelihood() + kPriorOfMember * fit.taken_in().size();
  return answer;
}

}  // namespace abbe::diagnosis
