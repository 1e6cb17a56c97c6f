// Worlds of a study worked out into its store, with progress: what abbe study and abbe fleet share.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "failure/failure.h"
#include "failure/located.h"
#include "study/deal.h"
#include "study/store.h"

namespace abbe::apps {

struct FillOptions {
  int threads = 0;
  bool quiet = false;
};

// Works out the seeds that the store lacks and puts it in their order. False when Ctrl-C ended it
// before: then it prints how to go on. `name`: of a seed, for the progress.
bool FillStore(const study::Study& study, const std::vector<std::uint64_t>& seeds,
               const std::string& title, const FillOptions& options, study::Ranks& ranks,
               study::Store& store, const std::function<std::string(std::uint64_t)>& name);

// What `read` makes of the rows of a store; InputError with its name where they do not say what
// abbe writes.
template <typename Read>
auto ReadRows(const std::filesystem::path& store, const Read& read) {
  return Located(store.string(), [&] {
    try {
      return read();
    } catch (const study::Row::exception&) {
      throw InputError("a row lacks what abbe writes; make the store anew");
    }
  });
}

}  // namespace abbe::apps
