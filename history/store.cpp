#include "history/store.h"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "failure/failure.h"
#include "history/store_tables.h"

namespace abbe::history {
namespace {

using nlohmann::json;

// JSON has no NaN: a missing number is null there.
std::vector<double> ListOf(const std::string& text) {
  std::vector<double> values;
  for (const json& each : json::parse(text)) {
    values.push_back(each.is_null() ? std::numeric_limits<double>::quiet_NaN()
                                    : each.get<double>());
  }
  return values;
}

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
