#include "history/store_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "failure/failure.h"
#include "history/schema.h"
#include "settings/nearest_word.h"

namespace abbe::history {
namespace {

std::string ListText(const std::vector<double>& values) { return nlohmann::json(values).dump(); }

std::string SharesText(const Shares& shares) {
  return shares.empty() ? "" : nlohmann::json(shares).dump();
}

}  // namespace

Store::Tables::Tables(const StoreAddress& address, Missing missing)
    : database_(address,
                missing == Missing::kMake ? Database::Missing::kMake : Database::Missing::kRefuse),
      notes_(BringUpToDate(database_, Migrations())) {}

std::vector<Added> Store::Tables::Add(std::span<const Campaign> campaigns, double now) {
  std::vector<Added> added;
  database_.InTransaction(Intent::kWrite, [&] {
    added.clear();
    for (const Campaign& campaign : campaigns) added.push_back(AddOne(campaign, now));
  });
  return added;
}

void Store::Tables::Forget(long long campaign) {
  database_.InTransaction(Intent::kWrite, [&] {
    Require(campaign);
    const std::vector<Value> id{Whole(campaign)};
    for (const char* const table : {"figure", "curve", "finding"}) {
      database_.Run(fmt::format("delete from {} where result_id in (select id from result where "
                                "campaign_id = :campaign)",
                                table),
                    id);
    }
    for (const char* const table : {"result", "map", "recording", "instrument"}) {
      database_.Run(fmt::format("delete from {} where campaign_id = :campaign", table), id);
    }
    database_.Run("delete from campaign where id = :campaign", id);
    database_.Run(
        "delete from machine_file where id not in (select machine_file_id from campaign where "
        "machine_file_id is not null)");
    database_.Run("delete from machine where id not in (select machine_id from campaign)");
  });
}

void Store::Tables::Require(long long campaign) {
  if (!Rows("select id from campaign where id = :id", {Whole(campaign)}).empty()) return;
  const auto ids = Rows("select id from campaign order by id desc limit 1");
  throw InputError(
      fmt::format("campaign {}: is not in {}; {}", campaign, database_.address().Shown(),
                  ids.empty() ? std::string("it holds none yet")
                              : fmt::format("the last one is {}; abbe history list shows all",
                                            ids.front().WholeAt(0))));
}

void Store::Tables::RequireMachine(const std::string& machine) {
  if (machine.empty()) return;
  std::vector<std::string> names;
  for (const Row& row : Rows("select name from machine order by name")) {
    names.push_back(row.TextAt(0));
  }
  if (std::ranges::find(names, machine) != names.end()) return;
  const std::string nearest = settings::NearestWord(machine, names);
  throw InputError(fmt::format("machine \"{}\": is not in {}; {}", machine,
                               database_.address().Shown(),
                               nearest.empty() ? std::string("it holds none yet")
                                               : fmt::format("did you mean \"{}\"?", nearest)));
}

Added Store::Tables::AddOne(const Campaign& campaign, double now) {
  const long long machine = MachineOf(campaign);
  Added added;
  std::vector<const ResultFile*> fresh;
  for (const ResultFile& result : campaign.results) {
    const auto rows =
        Rows("select campaign_id from result where machine_id = :machine and sha256 = :sha256",
             {Whole(machine), Text(result.sha256)});
    if (rows.empty()) {
      // The same content under two names is one result.
      const bool twice = std::ranges::any_of(
          fresh, [&](const ResultFile* each) { return each->sha256 == result.sha256; });
      if (!twice) fresh.push_back(&result);
      continue;
    }
    added.already_in = rows.front().WholeAt(0);
    ++added.left_out;
  }
  if (fresh.empty()) {
    const auto rows =
        Rows("select id from campaign where machine_id = :machine and sha256 = :sha256",
             {Whole(machine), Text(campaign.Sha256())});
    if (!rows.empty()) added.already_in = rows.front().WholeAt(0);
    if (!rows.empty() || !campaign.results.empty()) return added;
  }
  added.campaign = InsertCampaign(campaign, machine, now);
  InsertFiles(campaign, *added.campaign);
  for (const ResultFile* result : fresh) InsertResult(*result, machine, *added.campaign);
  return added;
}

long long Store::Tables::Insert(const std::string& statement, const std::vector<Value>& values) {
  return Rows(statement + " returning id", values).front().WholeAt(0);
}

long long Store::Tables::MachineOf(const Campaign& campaign) {
  const auto rows =
      Rows("select id, serial from machine where name = :name", {Text(campaign.machine)});
  if (rows.empty()) {
    return Insert("insert into machine (name, serial) values (:name, :serial)",
                  {Text(campaign.machine), Text(campaign.serial)});
  }
  const long long id = rows.front().WholeAt(0);
  if (!campaign.serial.empty() && rows.front().TextAt(1) != campaign.serial) {
    database_.Run("update machine set serial = :serial where id = :id",
                  {Text(campaign.serial), Whole(id)});
  }
  return id;
}

std::optional<long long> Store::Tables::FileOf(const Campaign& campaign) {
  if (!campaign.machine_file) return std::nullopt;
  const TextFile& file = *campaign.machine_file;
  const auto rows = Rows("select id from machine_file where sha256 = :sha256", {Text(file.sha256)});
  if (!rows.empty()) return rows.front().WholeAt(0);
  return Insert(
      "insert into machine_file (sha256, name, content) values (:sha256, :name, :content)",
      {Text(file.sha256), Text(file.name), Text(file.content)});
}

long long Store::Tables::InsertCampaign(const Campaign& campaign, long long machine, double now) {
  return Insert(
      "insert into campaign (machine_id, machine_file_id, name, serial, measured_s, added_s, "
      "operator, note, sha256) values (:machine, :file, :name, :serial, :measured, :added, :who, "
      ":note, :sha256)",
      {Whole(machine), Whole(FileOf(campaign)), Text(campaign.name), Text(campaign.serial),
       Real(campaign.measured), Real(now), Text(campaign.who), Text(campaign.note),
       Text(campaign.Sha256())});
}

void Store::Tables::InsertFiles(const Campaign& campaign, long long id) {
  for (const auto& [role, name] : campaign.instruments) {
    database_.Run("insert into instrument (campaign_id, role, name) values (:id, :role, :name)",
                  {Whole(id), Text(role), Text(name)});
  }
  long long place = 0;
  for (const RecordingFile& each : campaign.recordings) {
    database_.Run(
        "insert into recording (campaign_id, place, path, sha256, bytes, kind, started) values "
        "(:id, :place, :path, :sha256, :bytes, :kind, :started)",
        {Whole(id), Whole(place++), Text(each.path), Text(each.sha256), Whole(each.bytes),
         Text(each.kind), Text(each.started)});
  }
  place = 0;
  for (const TextFile& each : campaign.maps) {
    database_.Run(
        "insert into map (campaign_id, place, file, sha256, content) values (:id, :place, :file, "
        ":sha256, :content)",
        {Whole(id), Whole(place++), Text(each.name), Text(each.sha256), Text(each.content)});
  }
}

void Store::Tables::InsertResult(const ResultFile& result, long long machine, long long campaign) {
  const Extract& extract = result.extract;
  const long long id = Insert(
      "insert into result (campaign_id, machine_id, measured_s, file, sha256, command, kind, "
      "verdict, content) values (:campaign, :machine, :measured, :file, :sha256, :command, "
      ":kind, :verdict, :content)",
      {Whole(campaign), Whole(machine), Real(result.measured), Text(result.file),
       Text(result.sha256), Text(result.command), Text(result.kind), Text(extract.verdict),
       Text(result.content)});
  long long place = 0;
  for (const Figure& each : extract.figures) {
    database_.Run(
        "insert into figure (result_id, place, object, quantity, conditions, value, u, coverage, "
        "shares) values (:id, :place, :object, :quantity, :conditions, :value, :u, :coverage, "
        ":shares)",
        {Whole(id), Whole(place++), Text(each.object), Text(each.quantity), Text(each.conditions),
         Real(each.value), Real(each.u), Real(each.coverage), Text(SharesText(each.shares))});
  }
  place = 0;
  for (const Curve& each : extract.curves) {
    database_.Run(
        "insert into curve (result_id, place, object, unit, conditions, positions_mm, "
        "curve_values, u, coverage, shares) values (:id, :place, :object, :unit, :conditions, "
        ":positions, :values, :u, :coverage, :shares)",
        {Whole(id), Whole(place++), Text(each.object), Text(each.unit), Text(each.conditions),
         Text(ListText(each.positions_mm)), Text(ListText(each.value)), Text(ListText(each.u)),
         Real(each.coverage), Text(SharesText(each.shares))});
  }
  place = 0;
  for (const Finding& each : extract.findings) {
    database_.Run(
        "insert into finding (result_id, place, cause, object, probability) values (:id, :place, "
        ":cause, :object, :probability)",
        {Whole(id), Whole(place++), Text(each.cause), Text(each.object), Real(each.probability)});
  }
}

}  // namespace abbe::history
