#include <cmath>
#include <memory>
#include <utility>

#include "bindings.h"
#include "fleet/odd_machines.h"
#include "fleet/population_fit.h"
#include "fusion/fuse_sources.h"
#include "machine.h"
#include "progress.h"

namespace abbe::python {
namespace {

using fleet::Campaign;

Campaign CampaignOf(const std::vector<recording::Recording>& recordings, const MachineFile& type,
                    std::string machine, std::string name, const Asks& progress) {
  return Long(progress, [&] {
    auto report = fusion::FuseSources(type.SourcesOf(recordings), type.instruments,
                                      {.knots = fleet::KnotsOf(type.machine())});
    return Campaign{std::move(machine), std::move(name), std::move(report.seen)};
  });
}

// A fit with what it refers to.
struct Fleet {
  Fleet(machine::Machine type, std::vector<Campaign> of)
      : machine(std::move(type)),
        model(fusion::UnknownMachine(machine, fleet::KnotsOf(machine))),
        campaigns(std::move(of)),
        fit(machine, model, campaigns) {}
  Fleet(const Fleet&) = delete;

  const machine::Machine machine;
  const machine::VolumetricModel model;
  const std::vector<Campaign> campaigns;
  const fleet::PopulationFit fit;
};

std::unique_ptr<Fleet> FitFleet(const std::vector<Campaign>& campaigns, const MachineFile& type) {
  return std::make_unique<Fleet>(type.machine(), campaigns);
}

// {"population.smoothness_mm": (stated, seen, factor of U95)}, in the unit of the name.
py::dict PopulationOf(const Fleet& self) {
  py::dict result;
  for (const fusion::Statement& line : self.fit.statements()) {
    result[py::str(std::string(line.key))] =
        py::make_tuple(line.stated / line.unit, line.seen / line.unit, std::exp(2.0 * line.u_log));
  }
  return result;
}

py::list OddErrorsOf(const Fleet& self) {
  py::list list;
  for (const fleet::OddError& odd : fleet::OddErrors(self.fit)) {
    py::dict one;
    one["machine"] = odd.machine;
    one["error"] = odd.error;
    one["times"] = odd.times;
    one["p_value"] = odd.p_value;
    one["by_chance"] = odd.by_chance;
    one["certain"] = odd.is_certain();
    list.append(one);
  }
  return list;
}

py::list OddIdentitiesOf(const Fleet& self, double change) {
  py::list list;
  for (const auto& odd : fleet::OddIdentities(self.fit, self.campaigns, {.change = change})) {
    py::dict one;
    one["campaign"] = odd.campaign;
    one["said"] = odd.said;
    one["fits"] = odd.fits;
    one["log10_odds"] = odd.log10_odds;
    list.append(one);
  }
  return list;
}

}  // namespace

void BindFleet(py::module_& m) {
  py::class_<Campaign>(m, "Campaign",
                       "What the runs of one campaign tell of the errors of a machine, without "
                       "any prior of them.")
      .def_readonly("machine", &Campaign::machine, "Whose it is said to be.")
      .def_readonly("name", &Campaign::name)
      .def_property_readonly(
          "information",
          [](const py::object& self) {
            const auto& of = self.cast<const Campaign&>().seen.information;
            return py::array_t<double>({of.rows(), of.cols()}, {}, of.data(), self);
          },
          "Of the parameters of the machine's model, (n, n), SI.")
      .def(
          "__repr__",
          [](const Campaign& s) {
            return fmt::format("<abbe.Campaign \"{}\" of \"{}\">", s.name, s.machine);
          },
          "__repr__(self, /)\n--\n\n");
  m.def("campaign_of", &CampaignOf, py::arg("recordings"), py::arg("type"), py::arg("machine"),
        py::arg("name"), py::arg("progress") = py::none(),
        "campaign_of(recordings, type, machine, name, progress=None)\n--\n\n"
        "What recordings of one campaign tell, for fit_fleet; type: the machine file of the type; "
        "machine: whose they are said to be; name: of the campaign. progress(done, total, what): "
        "called as the work goes on.");
  py::class_<Fleet>(m, "Fleet", "What the machines of one type have in common, and which is odd.")
      .def_property_readonly(
          "machines", [](const Fleet& s) { return s.fit.machines(); }, "Each once.")
      .def_property_readonly("population", &PopulationOf,
                             "By key of the machine file: what it states, what the fleet has, and "
                             "the factor of its U95 (inf: the fleet does not tell), in the unit of "
                             "the key.")
      .def_property_readonly("odd_errors", &OddErrorsOf,
                             "Errors of a size that the others do not have, the clearest first: "
                             "machine, error, times, p_value, by_chance, certain.")
      .def("odd_identities", &OddIdentitiesOf, py::arg("change") = 0.2,
           "odd_identities(self, change=0.2)\n--\n\n"
           "Campaigns of another machine than is said: campaign, said, fits (\"\": none of the "
           "fleet), log10_odds. change: of the errors between two campaigns of a machine, in sizes "
           "of the population.")
      .def(
          "__repr__",
          [](const Fleet& s) {
            return fmt::format("<abbe.Fleet of {} machines, {} campaigns>", s.fit.machines().size(),
                               s.campaigns.size());
          },
          "__repr__(self, /)\n--\n\n");
  m.def("fit_fleet", &FitFleet, py::arg("campaigns"), py::arg("type"),
        py::call_guard<WithoutLock>(),
        "fit_fleet(campaigns, type)\n--\n\n"
        "The population of a fleet, as `abbe fleet fit`, from campaigns of campaign_of; type: the "
        "machine file of the type.");
}

}  // namespace abbe::python
