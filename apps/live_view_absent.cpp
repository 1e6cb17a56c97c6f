// Built without the folder live/: no option, no view.
#include "apps/commands.h"
#include "apps/live_view.h"

namespace abbe::apps {

void AddLiveOptions(CLI::App&, LiveOptions&) {}
std::unique_ptr<LiveView> OpenLive(const LiveOptions&, const LiveAbout&) { return {}; }
void AddLive(CLI::App&, int&) {}

}  // namespace abbe::apps
