// The history of machines: campaigns with their files, results, figures, curves and findings.
//
//   Store store(ReadAddress("history.db"), Store::Missing::kMake);
//   const Added added = store.Add(campaign, now);       // stored when this returns, or not at all
//   const std::vector<Point> points = store.PointsOf("demo-mill", "EYX", "straightness_um");
//
// Several programs may write at once. Names typed by people are data: they reach the store as bound
// parameters. Units: seconds since 1970; figures as in history/figure.h. Failure: as in
// history/database.h; InputError for a campaign or a machine that is not in the store.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "history/campaign.h"
#include "history/store_address.h"

namespace abbe::history {

struct CampaignHead {
  long long id = 0;
  std::string machine, serial, name, who, note;
  double measured = 0.0, added = 0.0;
  long long results = 0, recordings = 0, maps = 0;
};

// A figure or a curve with the campaign and the instant that it is of.
struct Point {
  long long campaign = 0;
  double measured = 0.0, added = 0.0;
  Figure figure;
};

struct StoredCampaign {
  CampaignHead head;
  std::optional<TextFile> machine_file;
  std::map<std::string, std::string> instruments;
  std::vector<RecordingFile> recordings;
  std::vector<TextFile> maps;
  std::vector<ResultFile> results;  // with their figures, curves and findings
};

struct Added {
  std::optional<long long> campaign;  // none: all of it was in the store
  long long already_in = 0;           // the campaign that holds what was in the store
  std::size_t left_out = 0;           // results that were in the store
};

class Store {
 public:
  enum class Missing { kRefuse, kMake };

  Store(const StoreAddress& address, Missing missing);
  ~Store();
  Store(Store&&) noexcept;

  // What the opening did, for the user: a migration and its copy.
  const std::vector<std::string>& notes() const;

  // Results of this machine with the same content are in the store once.
  Added Add(const Campaign& campaign, double now);
  // All in one transaction, for an import.
  std::vector<Added> AddAll(std::span<const Campaign> campaigns, double now);

  // By machine and instant; an empty `machine`: of all.
  std::vector<CampaignHead> List(const std::string& machine) const;
  StoredCampaign Read(long long campaign) const;
  // The newest campaign, of a machine or of all.
  long long Latest(const std::string& machine) const;

  std::vector<std::string> Machines() const;
  // The newest machine file of a machine.
  std::optional<TextFile> MachineFileOf(const std::string& machine) const;
  // Names of the figures of a machine, each once.
  std::vector<std::string> FigureNames(const std::string& machine) const;
  // In the order of their instants. An empty object or quantity: all.
  std::vector<Point> PointsOf(const std::string& machine, const std::string& object,
                              const std::string& quantity) const;
  // Instruments of the campaigns of a machine, by campaign.
  std::map<long long, std::map<std::string, std::string>> InstrumentsOf(
      const std::string& machine) const;

  void Forget(long long campaign);

 private:
  class Tables;
  std::unique_ptr<Tables> tables_;
};

}  // namespace abbe::history
