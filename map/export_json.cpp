#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "failure/failure.h"
#include "map/export_grid.h"
#include "map/text_file.h"

namespace abbe::map {
namespace {

using Json = nlohmann::ordered_json;

Json Triples(const Eigen::Matrix3Xd& values) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < values.cols(); ++i) {
    list.push_back({values(0, i) * 1e6, values(1, i) * 1e6, values(2, i) * 1e6});
  }
  return list;
}

Eigen::Matrix3Xd OfTriples(const Json& list) {
  Eigen::Matrix3Xd values(3, list.size());
  for (Eigen::Index i = 0; i < values.cols(); ++i) {
    for (Eigen::Index k = 0; k < 3; ++k) {
      values(k, i) = 1e-6 * list.at(i).at(k).get<double>();
    }
  }
  return values;
}

constexpr std::array kPositionKeys{"x_mm", "y_mm", "z_mm"};

GridFile FileOf(const Json& json, const std::string& where) {
  FileHeader header;
  header.machine = json.at("machine").get<std::string>();
  header.chain = json.at("chain").get<std::string>();
  header.positive = json.at("positive").get<std::string>();
  header.temperature = json.at("temperature_c").get<double>();
  header.scale = json.at("scale").get<std::string>();
  std::array<GridAxis, 3> axes;
  for (std::size_t k = 0; k < 3; ++k) {
    header.tool[k] = json.at("tool_mm").at(k).get<double>() * 1e-3;
    auto positions = json.at(kPositionKeys[k]).get<std::vector<double>>();
    for (double& position : positions) position *= 1e-3;
    axes[k] = AxisOfPositions(positions, where);
  }
  Eigen::Matrix3Xd u95;
  if (json.contains("u95_um")) u95 = OfTriples(json.at("u95_um"));
  return {header, MapGrid(axes, OfTriples(json.at("error_um")), std::move(u95))};
}

}  // namespace

Format::Paths WriteJsonGrid(const ErrorMap& map, const ExportOptions& options,
                            const std::filesystem::path& path) {
  const GridFile file = GridFileOf(map, options);
  const Eigen::Vector3d tool = file.header.tool * 1e3;
  Json json = {{"abbe-map-grid", 1},
               {"machine", file.header.machine},
               {"chain", file.header.chain},
               {"positive", file.header.positive},
               {"tool_mm", {tool.x(), tool.y(), tool.z()}},
               {"temperature_c", file.header.temperature},
               {"scale", file.header.scale},
               {"sign", kSignOfPoints}};
  for (std::size_t k = 0; k < 3; ++k) {
    json[kPositionKeys[k]] = Millimetres(file.grid.axes()[k]);
  }
  json["error_um"] = Triples(file.grid.error());
  if (file.grid.u95().size() > 0) json["u95_um"] = Triples(file.grid.u95());
  WriteWhole(json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n", path);
  return {path};
}

GridFile ReadJsonGrid(const std::filesystem::path& path) {
  try {
    return FileOf(Json::parse(ReadWhole(path)), path.string());
  } catch (const nlohmann::json::exception& failure) {
    const std::string_view what =
        failure.what();  // "[json.exception.type_error.302] type must ..."
    throw InputError(fmt::format("{}: is not a grid of a map from abbe export: {}", path.string(),
                                 what.substr(what.find("] ") + 2)));
  }
}

}  // namespace abbe::map
