// What a search answers under one simulation, and how probable that simulation and its answer are.
//
//   const Answer answer = Ask(campaign, std::make_shared<Search>(*campaign), 0.0);
//
// `worth`: logarithm of the marginal likelihood with the prior probabilities of the simulation
// (`prior`) and of all that was taken in, up to a constant of the readings; the greater one is the
// better answer.
// Units: SI. Failure: that of Fit.
#pragma once

#include <memory>

#include "diagnosis/diagnose.h"
#include "diagnosis/search.h"

namespace abbe::diagnosis {

struct Answer {
  std::shared_ptr<const Campaign> campaign;
  std::shared_ptr<const Search> search;
  Diagnosis diagnosis;
  double prior = 0.0, worth = 0.0;
};

// Runs the search, of this campaign.
Answer Ask(std::shared_ptr<const Campaign> campaign, const std::shared_ptr<Search>& search,
           double prior);

}  // namespace abbe::diagnosis
