#include <fmt/format.h>

#include <cmath>

#include "certificate/dcc.h"
#include "certificate/dcc_names.h"
#include "failure/failure.h"
#include "standards/chi_squared.h"

namespace abbe::certificate {
namespace {

constexpr const char* kProbability = "0.95";

// <name><dcc:content>text</dcc:content></name>
XmlElement Content(const std::string& name, const std::string& text) {
  XmlElement element(name);
  element.Add(XmlElement("dcc:content", text));
  return element;
}

std::string Dsi(const std::string& unit) {
  for (const auto& [own, dsi] : kDsiUnits) {
    if (unit == own) return dsi;
  }
  throw InputError(fmt::format("the unit \"{}\" has no name in D-SI yet", unit));
}

XmlElement Identification(const char* issuer, const std::string& value, const char* name) {
  XmlElement element("dcc:identification");
  element.AddText("dcc:issuer", issuer).AddText("dcc:value", value).Add(Content("dcc:name", name));
  return element;
}

XmlElement Software(const Certificate& certificate) {
  XmlElement software("dcc:software");
  software.Add(Content("dcc:name", certificate.software))
      .AddText("dcc:release", certificate.release)
      .AddText("dcc:type", "application");
  return XmlElement("dcc:dccSoftware").Add(std::move(software));
}

XmlElement RefTypes() {
  XmlElement definition("dcc:refTypeDefinition");
  definition.Add(Content("dcc:name", "Elements of a certificate written by abbe"))
      .AddText("dcc:namespace", "abbe")
      .AddText("dcc:link", "docs/certificate.md");
  return XmlElement("dcc:refTypeDefinitions").Add(std::move(definition));
}

XmlElement CoreData(const Administration& data) {
  XmlElement core("dcc:coreData");
  core.AddText("dcc:countryCodeISO3166_1", data.laboratory.country)
      .AddText("dcc:usedLangCodeISO639_1", "en")
      .AddText("dcc:mandatoryLangCodeISO639_1", "en")
      .AddText("dcc:uniqueIdentifier", data.number)
      .AddText("dcc:receiptDate", data.received)
      .AddText("dcc:beginPerformanceDate", data.begin)
      .AddText("dcc:endPerformanceDate", data.end)
      .AddText("dcc:performanceLocation", data.location)
      .AddText("dcc:issueDate", data.issued);
  return core;
}

XmlElement Contact(const char* name, const Organization& whose) {
  XmlElement place("dcc:location");
  place.AddText("dcc:street", whose.street)
      .AddText("dcc:postCode", whose.post_code)
      .AddText("dcc:city", whose.city)
      .AddText("dcc:countryCode", whose.country);
  XmlElement contact(name);
  contact.Add(Content("dcc:name", whose.name))
      .AddText("dcc:eMail", whose.email)
      .AddText("dcc:phone", whose.phone)
      .Add(std::move(place));
  return contact;
}

XmlElement Named(const char* name, const std::string& text) {
  return XmlElement(name).Add(Content("dcc:name", text));
}

XmlElement ItemElement(const Item& item) {
  XmlElement element("dcc:item");
  element.Add(Content("dcc:name", item.name))
      .Add(Named("dcc:manufacturer", item.manufacturer))
      .AddText("dcc:model", item.model)
      .Add(XmlElement("dcc:identifications")
               .Add(Identification("manufacturer", item.serial, "serial number")));
  return XmlElement("dcc:items").Add(std::move(element));
}

XmlElement People(const std::vector<Person>& people) {
  XmlElement list("dcc:respPersons");
  for (const Person& each : people) {
    XmlElement person("dcc:respPerson");
    person.Add(Named("dcc:person", each.name))
        .AddText("dcc:role", each.role)
        .AddText("dcc:mainSigner", each.signs ? "true" : "false");
    list.Add(std::move(person));
  }
  return list;
}

XmlElement Statement(const char* ref_type, const std::string& name, const std::string& text,
                     const std::string& norm = {}) {
  XmlElement statement("dcc:statement");
  statement.Set("refType", ref_type)
      .Add(Content("dcc:name", name))
      .AddText("dcc:norm", norm)
      .Add(Content("dcc:declaration", text));
  return statement;
}

XmlElement Statements(const Certificate& certificate) {
  XmlElement list("dcc:statements");
  const std::string& rule = certificate.administration.decision_rule;
  list.Add(rule == kIso14253 ? Statement(kDecisionRule, "Decision rule", kRule, rule)
                             : Statement(kDecisionRule, "Decision rule", kNoRule));
  for (const auto& text : certificate.doubts) {
    list.Add(Statement(kDoubt, "Reservation: no conformity is stated", text));
  }
  for (const auto& text : certificate.remarks) list.Add(Statement(kRemark, "Remark", text));
  return list;
}

XmlElement Instruments(const std::vector<Instrument>& instruments) {
  XmlElement list("dcc:measuringEquipments");
  for (const Instrument& each : instruments) {
    XmlElement element("dcc:measuringEquipment");
    element.Add(Content("dcc:name", each.name));
    if (!each.certificate_sha256.empty()) {
      XmlElement hash("dcc:certificate");
      hash.Add(Content("dcc:referral", each.certificate_by))
          .AddText("dcc:referralID", each.certificate)
          .AddText("dcc:procedure", "SHA-256")
          .AddText("dcc:value", each.certificate_sha256);
      element.Add(std::move(hash));
    }
    if (!each.manufacturer.empty()) element.Add(Named("dcc:manufacturer", each.manufacturer));
    element.AddText("dcc:model", each.model);
    XmlElement numbers("dcc:identifications");
    numbers.Add(Identification("manufacturer", each.serial, "serial number"));
    if (!each.certificate.empty() && each.certificate_sha256.empty()) {
      XmlElement number("dcc:identification");
      number.AddText("dcc:issuer", "other")
          .AddText("dcc:value", each.certificate)
          .Add(Content("dcc:name", each.certificate_by));
      numbers.Add(std::move(number));
    }
    list.Add(element.Add(std::move(numbers)));
  }
  return list;
}

XmlElement Real(const std::string& unit, double value) {
  XmlElement real("si:real");
  real.Add(XmlElement("si:value", NumbersText({value}))).Add(XmlElement("si:unit", Dsi(unit)));
  return real;
}

XmlElement Conditions(const Certificate& certificate) {
  XmlElement list("dcc:influenceConditions");
  for (const double temperature : certificate.temperature) {
    XmlElement condition("dcc:influenceCondition");
    condition.Set("refType", kTemperature)
        .Add(Content("dcc:name", "Temperature of the machine, to which the errors belong"))
        .Add(XmlElement("dcc:data").Add(XmlElement("dcc:quantity").Add(Real("degC", temperature))));
    list.Add(std::move(condition));
  }
  for (const Condition& each : certificate.administration.conditions) {
    XmlElement condition("dcc:influenceCondition");
    condition.Set("refType", kCondition)
        .Add(Content("dcc:name", each.name))
        .Add(XmlElement("dcc:data").Add(Content("dcc:text", each.text)));
    list.Add(std::move(condition));
  }
  return list;
}

std::string Repeated(const std::string& word, std::size_t count) {
  return WordsText(std::vector<std::string>(count, word));
}

// The list of D-SI; `units`: one of each value.
XmlElement RealList(const std::vector<std::string>& labels, const std::vector<double>& values,
                    const std::vector<std::string>& units) {
  std::vector<std::string> names;
  names.reserve(units.size());
  for (const std::string& unit : units) names.push_back(Dsi(unit));
  XmlElement list("si:realListXMLList");
  list.AddText("si:labelXMLList", WordsText(labels))
      .Add(XmlElement("si:valueXMLList", NumbersText(values)))
      .Add(XmlElement("si:unitXMLList", WordsText(names)));
  return list;
}

XmlElement Quantity(const char* ref_type, const std::string& name, XmlElement list) {
  XmlElement quantity("dcc:quantity");
  quantity.Set("refType", ref_type).Add(Content("dcc:name", name)).Add(std::move(list));
  return quantity;
}

XmlElement Result(const std::string& name, const std::string& words, XmlElement content) {
  XmlElement result("dcc:result");
  result.Add(Content("dcc:name", name));
  if (!words.empty()) result.Add(Content("dcc:description", words));
  return result.Add(XmlElement("dcc:data").Add(std::move(content)));
}

XmlElement SeriesElement(const Series& series, double coverage) {
  const std::size_t count = series.values.size();
  XmlElement list("dcc:list");
  list.Set("refType", kSeries);
  if (!series.positions.empty()) {
    list.Add(Quantity(
        kPositions, "position",
        RealList({}, series.positions, std::vector<std::string>(series.positions.size(), "m"))));
  }
  XmlElement values =
      RealList(series.labels, series.values, std::vector<std::string>(count, series.unit));
  if (!series.U95.empty()) {
    XmlElement expanded("si:expandedUncXMLList");
    expanded.Add(XmlElement("si:uncertaintyXMLList", NumbersText(series.U95)))
        .AddText("si:coverageFactorXMLList", Repeated(fmt::format("{}", coverage), count))
        .AddText("si:coverageProbabilityXMLList", Repeated(kProbability, count));
    values.Add(std::move(expanded));
  }
  list.Add(Quantity(kValues, series.name, std::move(values)));
  return Result(series.name, series.words, std::move(list));
}

// "m" and "rad" make "\metre\radian".
std::string ProductOf(const std::string& one, const std::string& other) {
  if (one.empty()) return Dsi(other);
  return other.empty() ? Dsi(one) : Dsi(one) + Dsi(other);
}

XmlElement JointElement(const Joint& joint) {
  const std::size_t count = joint.names.size();
  XmlElement matrix("si:covarianceMatrix");
  for (std::size_t i = 0; i < count; ++i) {
    XmlElement column("si:column");
    for (std::size_t j = 0; j < count; ++j) {
      XmlElement entry("si:covariance");
      entry.Add(XmlElement("si:value", NumbersText({joint.covariance[i * count + j]})))
          .Add(XmlElement("si:unit", ProductOf(joint.units[i], joint.units[j])));
      column.Add(std::move(entry));
    }
    matrix.Add(std::move(column));
  }
  const double squared = standards::ChiSquaredQuantile(0.95, static_cast<double>(count));
  XmlElement region("si:ellipsoidalRegionXMLList");
  region.Add(std::move(matrix))
      .AddText("si:coverageFactor", fmt::format("{:.6f}", std::sqrt(squared)))
      .AddText("si:coverageProbability", kProbability)
      .AddText("si:distribution", "normal");
  return Result("Parameters with covariance", joint.words,
                Quantity(kJoint, "parameters",
                         RealList(joint.names, joint.values, joint.units).Add(std::move(region))));
}

XmlElement ConformityElement(const Conformity& each, double coverage) {
  XmlElement value = Real(each.unit, each.value);
  value.Add(XmlElement("si:expandedUnc")
                .AddText("si:uncertainty", NumbersText({each.U95}))
                .AddText("si:coverageFactor", fmt::format("{}", coverage))
                .AddText("si:coverageProbability", kProbability));
  const auto quantity = [](const char* name, XmlElement real) {
    return XmlElement("dcc:quantity").Add(Content("dcc:name", name)).Add(std::move(real));
  };
  XmlElement meta("dcc:metaData");
  meta.Set("refType", kConformity)
      .Add(Content("dcc:name", each.name))
      .AddText("dcc:norm", kIso14253)
      .AddText("dcc:conformity", each.status)
      .Add(XmlElement("dcc:data")
               .Add(quantity("value", std::move(value)))
               .Add(quantity("limit", Real(each.unit, each.limit))));
  return meta;
}

XmlElement MeasurementResult(const Certificate& certificate) {
  XmlElement measured("dcc:measurementResult");
  measured.Add(Content("dcc:name", certificate.title));
  XmlElement methods("dcc:usedMethods");
  for (const std::string& each : certificate.methods) methods.Add(Named("dcc:usedMethod", each));
  measured.Add(std::move(methods));
  const auto& instruments = certificate.administration.instruments;
  if (!instruments.empty()) measured.Add(Instruments(instruments));
  XmlElement conditions = Conditions(certificate);
  if (!conditions.children.empty()) measured.Add(std::move(conditions));
  XmlElement results("dcc:results");
  for (const Series& each : certificate.results) {
    results.Add(SeriesElement(each, certificate.coverage));
  }
  for (const Joint& each : certificate.joint) results.Add(JointElement(each));
  measured.Add(std::move(results));
  if (certificate.conformities.empty()) return measured;
  XmlElement judged("dcc:measurementMetaData");
  for (const Conformity& each : certificate.conformities) {
    judged.Add(ConformityElement(each, certificate.coverage));
  }
  return measured.Add(std::move(judged));
}

}  // namespace

std::string DccText(const Certificate& certificate) {
  const Administration& data = certificate.administration;
  XmlElement laboratory("dcc:calibrationLaboratory");
  laboratory.AddText("dcc:calibrationLaboratoryCode", data.laboratory.code)
      .Add(Contact("dcc:contact", data.laboratory));
  XmlElement administration("dcc:administrativeData");
  administration.Add(Software(certificate))
      .Add(RefTypes())
      .Add(CoreData(data))
      .Add(ItemElement(data.item))
      .Add(std::move(laboratory))
      .Add(People(data.people))
      .Add(Contact("dcc:customer", data.customer))
      .Add(Statements(certificate));
  XmlElement root("dcc:digitalCalibrationCertificate");
  root.Set("schemaVersion", "3.2.0")
      .Set("xsi:schemaLocation", "https://ptb.de/dcc https://ptb.de/dcc/v3.2.0/dcc.xsd")
      .Add(std::move(administration))
      .Add(XmlElement("dcc:measurementResults").Add(MeasurementResult(certificate)));
  return XmlText(root, DccNamespaces());
}

}  // namespace abbe::certificate
