#include "apps/live_view.h"
#include "apps/machine_file.h"
#include "settings/unit.h"

namespace abbe::apps {

std::unique_ptr<recording::Writer> Watched(LiveView* view,
                                           std::unique_ptr<recording::Writer> writer,
                                           const std::vector<std::string>& columns,
                                           const std::filesystem::path& file) {
  return view == nullptr ? std::move(writer) : view->Watch(std::move(writer), columns, file);
}

std::map<std::string, double> GapRanges(const MachineFile& file) {
  std::map<std::string, double> ranges;
  for (std::size_t i = 0; i < probes::kProbes; ++i) {
    ranges[std::string("probe_") + static_cast<char>('a' + i) + "_um"] =
        file.sweep_setup.head.probes[i].range / settings::kMicrometre;
  }
  return ranges;
}

}  // namespace abbe::apps
