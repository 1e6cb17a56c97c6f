#include "history/store.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "failure/failure.h"
#include "history/database.h"
#include "history/schema.h"
#include "settings/nearest_word.h"

namespace abbe::history {
namespace {

using nlohmann::json;

std::string ListText(const std::vector<double>& values) { return json(values).dump(); }

// JSON has no NaN: a missing number is null there.
std::vector<double> ListOf(const std::string& text) {
  std::vector<double> values;
  for (const json& each : json::parse(text)) {
    values.push_back(each.is_null() ? std::numeric_limits<double>::quiet_NaN()
                                    : each.get<double>());
  }
  return values;
}

std::string SharesText(const Shares& shares) { return shares.empty() ? "" : json(shares).dump(); }
Shares SharesOf(const std::string& text) {
  return text.empty() ? Shares{} : json::parse(text).get<Shares>();
}

constexpr const char* kHeads =
    "select campaign.id, machine.name, campaign.serial, campaign.name, campaign.operator, "
    "campaign.note, campaign.measured_s, campaign.added_s, "
    "(select count(*) from result where result.campaign_id = campaign.id), "
    "(select count(*) from recording where recording.campaign_id = campaign.id), "
    "(select count(*) from map where map.campaign_id = campaign.id) "
    "from campaign join machine on machine.id = campaign.machine_id ";

CampaignHead HeadOf(const Row& row) {
  return {row.WholeAt(0), row.TextAt(1),  row.TextAt(2),  row.TextAt(3),
          row.TextAt(4),  row.TextAt(5),  *row.RealAt(6), *row.RealAt(7),
          row.WholeAt(8), row.WholeAt(9), row.WholeAt(10)};
}

// The columns of a figure from `first` on: object, quantity, conditions, value, u, coverage,
// shares.
Figure FigureOf(const Row& row, std::size_t first) {
  return {row.TextAt(first),
          row.TextAt(first + 1),
          row.TextAt(first + 2),
          *row.RealAt(first + 3),
          row.RealAt(first + 4),
          *row.RealAt(first + 5),
          SharesOf(row.TextAt(first + 6))};
}

}  // namespace

class Store::Tables {
 public:
  Tables(const StoreAddress& address, Missing missing)
      : database_(address, missing == Missing::kMake ? Database::Missing::kMake
                                                     : Database::Missing::kRefuse),
        notes_(BringUpToDate(database_, Migrations())) {}

  const std::vector<std::string>& notes() const { return notes_; }

  std::vector<Added> Add(std::span<const Campaign> campaigns, double now) {
    std::vector<Added> added;
    database_.InTransaction(Intent::kWrite, [&] {
      added.clear();
      for (const Campaign& campaign : campaigns) added.push_back(AddOne(campaign, now));
    });
    return added;
  }

  template <typename Use>
  void Reading(const Use& use) {
    database_.InTransaction(Intent::kRead, use);
  }

  std::vector<Row> Rows(const std::string& statement, const std::vector<Value>& values = {}) {
    return database_.Rows(statement, values);
  }

  void Forget(long long campaign) {
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

  // InputError unless there is such a campaign.
  void Require(long long campaign) {
    if (!Rows("select id from campaign where id = :id", {Whole(campaign)}).empty()) return;
    const auto ids = Rows("select id from campaign order by id desc limit 1");
    throw InputError(
        fmt::format("campaign {}: is not in {}; {}", campaign, database_.address().Shown(),
                    ids.empty() ? std::string("it holds none yet")
                                : fmt::format("the last one is {}; abbe history list shows all",
                                              ids.front().WholeAt(0))));
  }

  void RequireMachine(const std::string& machine) {
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

 private:
  Added AddOne(const Campaign& campaign, double now) {
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

  long long Insert(const std::string& statement, const std::vector<Value>& values) {
    return Rows(statement + " returning id", values).front().WholeAt(0);
  }

  long long MachineOf(const Campaign& campaign) {
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

  std::optional<long long> FileOf(const Campaign& campaign) {
    if (!campaign.machine_file) return std::nullopt;
    const TextFile& file = *campaign.machine_file;
    const auto rows =
        Rows("select id from machine_file where sha256 = :sha256", {Text(file.sha256)});
    if (!rows.empty()) return rows.front().WholeAt(0);
    return Insert(
        "insert into machine_file (sha256, name, content) values (:sha256, :name, :content)",
        {Text(file.sha256), Text(file.name), Text(file.content)});
  }

  long long InsertCampaign(const Campaign& campaign, long long machine, double now) {
    return Insert(
        "insert into campaign (machine_id, machine_file_id, name, serial, measured_s, added_s, "
        "operator, note, sha256) values (:machine, :file, :name, :serial, :measured, :added, :who, "
        ":note, :sha256)",
        {Whole(machine), Whole(FileOf(campaign)), Text(campaign.name), Text(campaign.serial),
         Real(campaign.measured), Real(now), Text(campaign.who), Text(campaign.note),
         Text(campaign.Sha256())});
  }

  void InsertFiles(const Campaign& campaign, long long id) {
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

  void InsertResult(const ResultFile& result, long long machine, long long campaign) {
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

  Database database_;
  std::vector<std::string> notes_;
};

Store::Store(const StoreAddress& address, Missing missing)
    : tables_(std::make_unique<Tables>(address, missing)) {}
Store::~Store() = default;
Store::Store(Store&&) noexcept = default;

const std::vector<std::string>& Store::notes() const { return tables_->notes(); }

Added Store::Add(const Campaign& campaign, double now) {
  return AddAll(std::span(&campaign, 1), now).front();
}

std::vector<Added> Store::AddAll(std::span<const Campaign> campaigns, double now) {
  return tables_->Add(campaigns, now);
}

std::vector<CampaignHead> Store::List(const std::string& machine) const {
  std::vector<CampaignHead> heads;
  tables_->Reading([&] {
    heads.clear();
    tables_->RequireMachine(machine);
    const auto rows = machine.empty()
                          ? tables_->Rows(std::string(kHeads) +
                                          "order by machine.name, campaign.measured_s, campaign.id")
                          : tables_->Rows(std::string(kHeads) +
                                              "where machine.name = :machine order by "
                                              "campaign.measured_s, campaign.id",
                                          {Text(machine)});
    for (const Row& row : rows) heads.push_back(HeadOf(row));
  });
  return heads;
}

long long Store::Latest(const std::string& machine) const {
  long long latest = 0;
  tables_->Reading([&] {
    tables_->RequireMachine(machine);
    const std::string order = " order by campaign.measured_s desc, campaign.id desc limit 1";
    const auto rows = machine.empty()
                          ? tables_->Rows("select id from campaign" + order)
                          : tables_->Rows(
                                "select campaign.id from campaign join machine on machine.id = "
                                "campaign.machine_id where machine.name = :machine" +
                                    order,
                                {Text(machine)});
    if (rows.empty()) throw InputError("the history holds no campaign yet; add one first");
    latest = rows.front().WholeAt(0);
  });
  return latest;
}

std::vector<std::string> Store::Machines() const {
  std::vector<std::string> names;
  tables_->Reading([&] {
    names.clear();
    for (const Row& row : tables_->Rows("select name from machine order by name")) {
      names.push_back(row.TextAt(0));
    }
  });
  return names;
}

std::optional<TextFile> Store::MachineFileOf(const std::string& machine) const {
  std::optional<TextFile> file;
  tables_->Reading([&] {
    const auto rows = tables_->Rows(
        "select machine_file.name, machine_file.sha256, machine_file.content from campaign join "
        "machine on machine.id = campaign.machine_id join machine_file on machine_file.id = "
        "campaign.machine_file_id where machine.name = :machine order by campaign.added_s desc, "
        "campaign.id desc limit 1",
        {Text(machine)});
    if (!rows.empty()) {
      file = {rows.front().TextAt(0), rows.front().TextAt(1), rows.front().TextAt(2)};
    }
  });
  return file;
}

std::vector<std::string> Store::FigureNames(const std::string& machine) const {
  std::vector<std::string> names;
  tables_->Reading([&] {
    names.clear();
    for (const Row& row : tables_->Rows(
             "select distinct figure.object, figure.quantity from result join figure on "
             "figure.result_id = result.id where result.machine_id = (select id from machine where "
             "name = :machine) order by figure.object, figure.quantity",
             {Text(machine)})) {
      names.push_back(Figure{row.TextAt(0), row.TextAt(1), "", 0.0, {}}.Name());
    }
  });
  return names;
}

std::vector<Point> Store::PointsOf(const std::string& machine, const std::string& object,
                                   const std::string& quantity) const {
  std::vector<Point> points;
  tables_->Reading([&] {
    points.clear();
    tables_->RequireMachine(machine);
    std::string statement =
        "select campaign.id, result.measured_s, campaign.added_s, figure.object, figure.quantity, "
        "figure.conditions, figure.value, figure.u, figure.coverage, figure.shares from result "
        "join figure on figure.result_id = result.id join campaign on campaign.id = "
        "result.campaign_id where result.machine_id = (select id from machine where name = "
        ":machine)";
    std::vector<Value> values{Text(machine)};
    if (!object.empty()) {
      statement += " and figure.object = :object";
      values.push_back(Text(object));
    }
    if (!quantity.empty()) {
      statement += " and figure.quantity = :quantity";
      values.push_back(Text(quantity));
    }
    for (const Row& row : tables_->Rows(
             statement + " order by result.measured_s, result.id, figure.place", values)) {
      points.push_back({row.WholeAt(0), *row.RealAt(1), *row.RealAt(2), FigureOf(row, 3)});
    }
  });
  return points;
}

std::map<long long, std::map<std::string, std::string>> Store::InstrumentsOf(
    const std::string& machine) const {
  std::map<long long, std::map<std::string, std::string>> instruments;
  tables_->Reading([&] {
    instruments.clear();
    for (const Row& row : tables_->Rows(
             "select campaign.id, campaign.serial, instrument.role, instrument.name from campaign "
             "left join instrument on instrument.campaign_id = campaign.id where "
             "campaign.machine_id = (select id from machine where name = :machine)",
             {Text(machine)})) {
      auto& of = instruments[row.WholeAt(0)];
      if (!row.TextAt(1).empty()) of["serial"] = row.TextAt(1);
      if (!row.TextAt(2).empty()) of[row.TextAt(2)] = row.TextAt(3);
    }
  });
  return instruments;
}

StoredCampaign Store::Read(long long campaign) const {
  StoredCampaign stored;
  tables_->Reading([&] {
    stored = {};
    tables_->Require(campaign);
    const std::vector<Value> id{Whole(campaign)};
    stored.head =
        HeadOf(tables_->Rows(std::string(kHeads) + "where campaign.id = :id", id).front());
    for (const Row& row : tables_->Rows(
             "select machine_file.name, machine_file.sha256, machine_file.content from campaign "
             "join machine_file on machine_file.id = campaign.machine_file_id where campaign.id = "
             ":id",
             id)) {
      stored.machine_file = {row.TextAt(0), row.TextAt(1), row.TextAt(2)};
    }
    if (!stored.head.serial.empty()) stored.instruments["serial"] = stored.head.serial;
    for (const Row& row :
         tables_->Rows("select role, name from instrument where campaign_id = :id", id)) {
      stored.instruments[row.TextAt(0)] = row.TextAt(1);
    }
    for (const Row& row : tables_->Rows("select path, sha256, kind, started, bytes from recording "
                                        "where campaign_id = :id order by place",
                                        id)) {
      stored.recordings.push_back(
          {row.TextAt(0), row.TextAt(1), row.TextAt(2), row.TextAt(3), row.WholeAt(4)});
    }
    for (const Row& row : tables_->Rows(
             "select file, sha256, content from map where campaign_id = :id order by place", id)) {
      stored.maps.push_back({row.TextAt(0), row.TextAt(1), row.TextAt(2)});
    }
    std::map<long long, std::size_t> place_of;
    for (const Row& row :
         tables_->Rows("select id, file, sha256, content, command, kind, measured_s, verdict from "
                       "result where campaign_id = :id order by id",
                       id)) {
      place_of[row.WholeAt(0)] = stored.results.size();
      ResultFile& result = stored.results.emplace_back();
      result = {row.TextAt(1),
                row.TextAt(2),
                row.TextAt(3),
                row.TextAt(4),
                row.TextAt(5),
                *row.RealAt(6),
                {}};
      result.extract.verdict = row.TextAt(7);
    }
    const auto rows_of = [&](const std::string& columns, const std::string& table) {
      return tables_->Rows(
          fmt::format("select result_id, {} from {} where result_id in (select id from result "
                      "where campaign_id = :id) order by result_id, place",
                      columns, table),
          id);
    };
    const auto extract_of = [&](const Row& row) -> Extract& {
      return stored.results[place_of.at(row.WholeAt(0))].extract;
    };
    for (const Row& row :
         rows_of("object, quantity, conditions, value, u, coverage, shares", "figure")) {
      extract_of(row).figures.push_back(FigureOf(row, 1));
    }
    for (const Row& row :
         rows_of("object, unit, conditions, positions_mm, curve_values, u, coverage, shares",
                 "curve")) {
      extract_of(row).curves.push_back(
          {row.TextAt(1), row.TextAt(2), row.TextAt(3), ListOf(row.TextAt(4)),
           ListOf(row.TextAt(5)), ListOf(row.TextAt(6)), *row.RealAt(7), SharesOf(row.TextAt(8))});
    }
    for (const Row& row : rows_of("cause, object, probability", "finding")) {
      extract_of(row).findings.push_back({row.TextAt(1), row.TextAt(2), *row.RealAt(3)});
    }
  });
  return stored;
}

void Store::Forget(long long campaign) { tables_->Forget(campaign); }

}  // namespace abbe::history
