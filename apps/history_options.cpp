#include "apps/history_options.h"

#include <fmt/format.h>

#include <chrono>

#include "apps/result_file.h"
#include "failure/failure.h"

namespace abbe::apps {

double SecondsNow() {
  return static_cast<double>(
      std::chrono::system_clock::to_time_t(std::chrono::system_clock::now()));
}

history::Store OpenStore(const HistoryOptions& options, history::Store::Missing missing) {
  const history::StoreAddress address =
      options.store.empty() ? history::DefaultAddress() : history::ReadAddress(options.store);
  history::Store store(address, missing);
  if (options.store.empty()) ShowHistory(options, fmt::format("store: {}\n", address.Shown()));
  for (const std::string& note : store.notes()) fmt::print(stderr, "abbe: {}\n", note);
  return store;
}

void ShowHistory(const HistoryOptions& options, const std::string& text) {
  if (!options.quiet) fmt::print("{}", text);
}

void KeepHistory(const HistoryOptions& options, const nlohmann::ordered_json& result) {
  if (!options.json.empty()) WriteResult(result, options.json);
}

long long CampaignNumber(const std::string& text, const std::string& machine,
                         const history::Store& store) {
  if (text == "latest") return store.Latest(machine);
  try {
    std::size_t end = 0;
    const long long id = std::stoll(text, &end);
    if (end == text.size()) return id;
  } catch (const std::logic_error&) {  // not a number, or a longer one than any campaign's
  }
  throw InputError(fmt::format(
      "{}: is no campaign; give the number that abbe history list shows, or latest", text));
}

}  // namespace abbe::apps
