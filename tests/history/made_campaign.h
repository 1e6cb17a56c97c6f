// Campaigns made by hand, and stores in a folder of their own.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "history/campaign.h"
#include "history/store.h"
#include "recording/file_hash.h"
#include "tests/recording/scratch.h"

namespace abbe::history {

using recording::Bytes;
using recording::ExpectHas;
using recording::MessageOf;
using recording::Scratch;

// A result with these figures; `text` stands for its JSON and makes it another one.
inline ResultFile MadeResult(std::vector<Figure> figures, double measured,
                             const std::string& text) {
  ResultFile result{"made.json", recording::Sha256OfText(text), text, "circle", "", measured, {}};
  result.extract.figures = std::move(figures);
  return result;
}

inline Campaign MadeCampaign(const std::string& machine, double measured,
                             std::vector<ResultFile> results) {
  Campaign campaign;
  campaign.machine = machine;
  campaign.measured = measured;
  campaign.results = std::move(results);
  return campaign;
}

}  // namespace abbe::history
