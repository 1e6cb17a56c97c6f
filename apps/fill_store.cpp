#include "apps/fill_store.h"

#include <fmt/format.h>

#include "apps/interrupt.h"
#include "apps/progress.h"

namespace abbe::apps {

bool FillStore(const study::Study& study, const std::vector<std::uint64_t>& seeds,
               const std::string& title, const FillOptions& options, study::Ranks& ranks,
               study::Store& store, const std::function<std::string(std::uint64_t)>& name) {
  study::Dealing dealing{.seeds = {}, .threads = options.threads, .ended = &InterruptFlag()};
  for (const std::uint64_t seed : seeds) {
    if (!store.rows().contains(seed)) dealing.seeds.push_back(seed);
  }
  const std::size_t wanted = dealing.seeds.size();
  std::size_t done = 0;
  {
    Progress progress(title, options.quiet);
    study::Deal(study, dealing, ranks, [&](std::uint64_t seed, const study::Row& row) {
      store.Add(seed, row);
      progress.Show(++done, wanted, name(seed));
    });
  }
  if (done < wanted) {
    fmt::print("{} of {} are kept; the same command with --resume goes on\n", done, wanted);
    return false;
  }
  store.Finish();
  return true;
}

}  // namespace abbe::apps
