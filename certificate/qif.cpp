#include "certificate/qif.h"

#include <fmt/format.h>

#include <array>

#include "certificate/xml.h"
#include "failure/failure.h"
#include "recording/file_hash.h"

namespace abbe::certificate {
namespace {

struct Field {
  const char* element;
  const char* error;
  double sign = 1.0;
};

constexpr std::array<Field, 21> kFields{{
    {"XLinearity", "EXX"},         {"YLinearity", "EYY"},         {"ZLinearity", "EZZ"},
    {"XAxisRoll", "EAX"},          {"XAxisPitch", "EBX"},         {"XAxisYaw", "ECX"},
    {"YAxisRoll", "EBY"},          {"YAxisPitch", "EAY"},         {"YAxisYaw", "ECY"},
    {"ZAxisRoll", "ECZ"},          {"ZAxisPitch", "EAZ"},         {"ZAxisYaw", "EBZ"},
    {"XAxisStraightnessY", "EYX"}, {"XAxisStraightnessZ", "EZX"}, {"YAxisStraightnessX", "EXY"},
    {"YAxisStraightnessZ", "EZY"}, {"ZAxisStraightnessX", "EXZ"}, {"ZAxisStraightnessY", "EYZ"},
    {"XYSquareness", "C0Y"},       {"XZSquareness", "B0Z", -1.0}, {"YZSquareness", "A0Z"},
}};

constexpr const char* kU95 = "U95 ";
constexpr const char* kUncertaintyFactor = "coverage factor of U95";
constexpr const char* kNumber = "certificate";
constexpr const char* kLaboratory = "calibration laboratory";
constexpr const char* kCustomer = "customer";
constexpr const char* kTemperatureName = "temperature of the machine, degC";
constexpr const char* kRemarkName = "remark";
constexpr const char* kDoubtName = "reservation, no conformity is stated";

std::vector<XmlNamespace> Namespaces() {
  return {{"", "http://qifstandards.org/xsd/qif3"},
          {"xsi", "http://www.w3.org/2001/XMLSchema-instance"}};
}

const Series& Find(const Certificate& certificate, const std::string& name) {
  for (const Series& each : certificate.results) {
    if (each.name == name) return each;
  }
  throw InputError(
      fmt::format("the result has no {}; QIF needs all 21 errors: take --format dcc", name));
}

// Adding 0 makes a negative zero a plain one.
std::vector<double> Times(double sign, std::vector<double> values) {
  for (double& value : values) value = sign * value + 0.0;
  return values;
}

// A name for the document that its content determines, in the form of a UUID.
std::string QpId(const Certificate& certificate) {
  std::string text = certificate.administration.number + certificate.title;
  for (const Series& each : certificate.results) text += NumbersText(each.values);
  const std::string hash = recording::Sha256OfText(text);
  return fmt::format("{}-{}-{}-{}-{}", hash.substr(0, 8), hash.substr(8, 4), hash.substr(12, 4),
                     hash.substr(16, 4), hash.substr(20, 12));
}

XmlElement Attributes(const Certificate& certificate) {
  XmlElement list("Attributes");
  const auto add = [&](const std::string& name, const std::string& value) {
    list.Add(XmlElement("AttributeStr").Set("name", name).Set("value", value));
  };
  add(kNumber, certificate.administration.number);
  add(kLaboratory, certificate.administration.laboratory.name);
  add(kCustomer, certificate.administration.customer.name);
  for (const double each : certificate.temperature) add(kTemperatureName, NumbersText({each}));
  for (const std::string& each : certificate.doubts) add(kDoubtName, each);
  for (const std::string& each : certificate.remarks) add(kRemarkName, each);
  add(kUncertaintyFactor, NumbersText({certificate.coverage}));
  for (const Field& field : kFields) {
    add(std::string(kU95) + field.error, NumbersText(Find(certificate, field.error).U95));
  }
  list.Set("n", fmt::format("{}", list.children.size()));
  return list;
}

XmlElement Test(const Certificate& certificate) {
  XmlElement test("CartesianCMMFPSTest");
  for (const Field& field : kFields) {
    const Series& series = Find(certificate, field.error);
    const std::string values = NumbersText(Times(field.sign, series.values));
    if (series.positions.empty()) {
      test.AddText(field.element, values);
      continue;
    }
    XmlElement function(field.element);
    function.Set("n", fmt::format("{}", series.values.size()))
        .AddText("DomainValues", NumbersText(series.positions))
        .AddText("RangeValues", values)
        .AddText("DomainLinearUnit", "m")
        .AddText(series.unit == "m" ? "RangeLinearUnit" : "RangeAngularUnit", series.unit);
    test.Add(std::move(function));
  }
  return test;
}

XmlElement Machine(const Certificate& certificate) {
  const Item& item = certificate.administration.item;
  XmlElement accuracy("CartesianCMMAccuracy");
  accuracy
      .Add(XmlElement("EnvironmentalRange")
               .AddText("Description", "the conditions of the calibration"))
      .Add(Test(certificate))
      .Add(XmlElement("AccuracySource").AddText("AccuracySourceEnum", "CUSTOM_CERTIFICATION"));
  XmlElement machine("CartesianCMM");
  machine.Set("id", "1")
      .AddText("Name", item.name)
      .AddText("Description", certificate.title)
      .AddText("Manufacturer", item.manufacturer)
      .AddText("ModelNumber", item.model)
      .AddText("SerialNumber", item.serial)
      .Add(Attributes(certificate))
      .Add(XmlElement("Accuracies").Set("n", "1").Add(std::move(accuracy)));
  return machine;
}

XmlElement Units() {
  XmlElement angle("AngularUnit"), length("LinearUnit");
  angle.AddText("SIUnitName", "radian").AddText("UnitName", "rad");
  length.AddText("SIUnitName", "meter").AddText("UnitName", "m");
  return XmlElement("FileUnits")
      .Add(XmlElement("PrimaryUnits").Add(std::move(angle)).Add(std::move(length)));
}

void ReadAttributes(const XmlElement& list, Certificate& certificate) {
  for (const XmlElement* each : list.All("AttributeStr")) {
    const std::string name = each->Attribute("name"), value = each->Attribute("value");
    XmlElement numbers("value", value);
    numbers.line = each->line;
    if (name == kNumber) certificate.administration.number = value;
    if (name == kLaboratory) certificate.administration.laboratory.name = value;
    if (name == kCustomer) certificate.administration.customer.name = value;
    if (name == kTemperatureName) certificate.temperature.push_back(NumberOf(numbers));
    if (name == kDoubtName) certificate.doubts.push_back(value);
    if (name == kRemarkName) certificate.remarks.push_back(value);
    if (name == kUncertaintyFactor) certificate.coverage = NumberOf(numbers);
    for (Series& series : certificate.results) {
      if (name == kU95 + series.name) series.U95 = NumbersOf(numbers);
    }
  }
}

}  // namespace

std::string QifText(const Certificate& certificate) {
  XmlElement root("QIFDocument");
  root.Set("xsi:schemaLocation", "http://qifstandards.org/xsd/qif3 QIFDocument.xsd")
      .Set("idMax", "1")
      .Set("versionQIF", "3.0.0")
      .AddText("QPId", QpId(certificate))
      .Add(XmlElement("Header").Add(
          XmlElement("Application")
              .AddText("Name", certificate.software + " " + certificate.release)))
      .Add(Units())
      .Add(XmlElement("MeasurementResources")
               .Add(XmlElement("MeasurementDevices").Set("n", "1").Add(Machine(certificate))));
  return XmlText(root, Namespaces());
}

Certificate ReadQif(std::string_view text, const std::string& name) {
  const XmlElement root = ParseXml(text, name, Namespaces());
  if (root.name != "QIFDocument") {
    throw InputError(
        fmt::format("{}: is no QIF document; its first element is <{}>", name, root.name));
  }
  try {
    Certificate certificate;
    const XmlElement& machine =
        root.At("MeasurementResources").At("MeasurementDevices").At("CartesianCMM");
    certificate.title = machine.TextOf("Description");
    certificate.administration.item = {machine.TextOf("Name"), machine.TextOf("Manufacturer"),
                                       machine.TextOf("ModelNumber"),
                                       machine.TextOf("SerialNumber")};
    const XmlElement& test =
        machine.At("Accuracies").At("CartesianCMMAccuracy").At("CartesianCMMFPSTest");
    for (const Field& field : kFields) {
      const XmlElement& element = test.At(field.element);
      Series series;
      series.name = field.error;
      if (const XmlElement* domain = element.Find("DomainValues")) {
        series.positions = NumbersOf(*domain);
        series.values = Times(field.sign, NumbersOf(element.At("RangeValues")));
        series.unit = element.TextOf("RangeLinearUnit") + element.TextOf("RangeAngularUnit");
      } else {
        series.values = Times(field.sign, NumbersOf(element));
        series.unit = "rad";
      }
      certificate.results.push_back(std::move(series));
    }
    ReadAttributes(machine.At("Attributes"), certificate);
    return certificate;
  } catch (const InputError& failure) {
    throw InputError(fmt::format("{}: {}; it holds no 21 errors of abbe", name, failure.what()));
  }
}

Certificate KeptByQif(const Certificate& certificate) {
  Certificate kept;
  kept.title = certificate.title;
  kept.administration.number = certificate.administration.number;
  kept.administration.item = certificate.administration.item;
  kept.administration.laboratory.name = certificate.administration.laboratory.name;
  kept.administration.customer.name = certificate.administration.customer.name;
  kept.temperature = certificate.temperature;
  kept.doubts = certificate.doubts;
  kept.remarks = certificate.remarks;
  kept.coverage = certificate.coverage;
  for (const Field& field : kFields) {
    kept.results.push_back(Find(certificate, field.error));
    Series& series = kept.results.back();
    series.words.clear();
    series.labels.clear();
    series.values = Times(1.0, series.values);
  }
  return kept;
}

}  // namespace abbe::certificate
