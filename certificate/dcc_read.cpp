#include <fmt/format.h>

#include "certificate/dcc.h"
#include "certificate/dcc_names.h"
#include "failure/failure.h"

namespace abbe::certificate {
namespace {

std::string ContentOf(const XmlElement& parent, const char* child) {
  const XmlElement* found = parent.Find(child);
  return found == nullptr ? std::string() : found->At("dcc:content").text;
}

std::string NameIn(const XmlElement& parent, const char* child) {
  const XmlElement* found = parent.Find(child);
  return found == nullptr ? std::string() : ContentOf(*found, "dcc:name");
}

std::string OwnUnit(const std::string& dsi, long line) {
  for (const auto& [own, name] : kDsiUnits) {
    if (dsi == name) return own;
  }
  throw InputError(fmt::format("line {}: the unit {} is none that abbe writes", line, dsi));
}

std::vector<std::string> UnitsOf(const XmlElement& list) {
  const XmlElement& element = list.At("si:unitXMLList");
  std::vector<std::string> units;
  for (const std::string& word : WordsOf(element)) units.push_back(OwnUnit(word, element.line));
  if (units.size() != NumbersOf(list.At("si:valueXMLList")).size()) {
    throw InputError(fmt::format("line {}: has not one unit a value", element.line));
  }
  return units;
}

Organization ReadContact(const XmlElement& contact) {
  Organization read;
  read.name = ContentOf(contact, "dcc:name");
  read.email = contact.TextOf("dcc:eMail");
  read.phone = contact.TextOf("dcc:phone");
  const XmlElement& place = contact.At("dcc:location");
  read.street = place.TextOf("dcc:street");
  read.post_code = place.TextOf("dcc:postCode");
  read.city = place.TextOf("dcc:city");
  read.country = place.TextOf("dcc:countryCode");
  return read;
}

Item ReadItemOf(const XmlElement& item) {
  return {ContentOf(item, "dcc:name"), NameIn(item, "dcc:manufacturer"), item.TextOf("dcc:model"),
          item.At("dcc:identifications").At("dcc:identification").TextOf("dcc:value")};
}

Instrument ReadInstrumentOf(const XmlElement& element) {
  Instrument read;
  read.name = ContentOf(element, "dcc:name");
  read.manufacturer = NameIn(element, "dcc:manufacturer");
  read.model = element.TextOf("dcc:model");
  const auto numbers = element.At("dcc:identifications").All("dcc:identification");
  for (const XmlElement* each : numbers) {
    if (each->TextOf("dcc:issuer") == "manufacturer") {
      read.serial = each->TextOf("dcc:value");
    } else {
      read.certificate = each->TextOf("dcc:value");
      read.certificate_by = ContentOf(*each, "dcc:name");
    }
  }
  if (const XmlElement* hash = element.Find("dcc:certificate")) {
    read.certificate = hash->TextOf("dcc:referralID");
    read.certificate_by = ContentOf(*hash, "dcc:referral");
    read.certificate_sha256 = hash->TextOf("dcc:value");
  }
  return read;
}

void ReadAdministrative(const XmlElement& root, Certificate& certificate) {
  Administration& data = certificate.administration;
  const XmlElement& software = root.At("dcc:dccSoftware").At("dcc:software");
  certificate.software = ContentOf(software, "dcc:name");
  certificate.release = software.TextOf("dcc:release");
  const XmlElement& core = root.At("dcc:coreData");
  data.number = core.TextOf("dcc:uniqueIdentifier");
  data.received = core.TextOf("dcc:receiptDate");
  data.begin = core.TextOf("dcc:beginPerformanceDate");
  data.end = core.TextOf("dcc:endPerformanceDate");
  data.location = core.TextOf("dcc:performanceLocation");
  data.issued = core.TextOf("dcc:issueDate");
  data.item = ReadItemOf(root.At("dcc:items").At("dcc:item"));
  const XmlElement& laboratory = root.At("dcc:calibrationLaboratory");
  data.laboratory = ReadContact(laboratory.At("dcc:contact"));
  data.laboratory.code = laboratory.TextOf("dcc:calibrationLaboratoryCode");
  for (const XmlElement* each : root.At("dcc:respPersons").All("dcc:respPerson")) {
    data.people.push_back({NameIn(*each, "dcc:person"), each->TextOf("dcc:role"),
                           each->TextOf("dcc:mainSigner") == "true"});
  }
  data.customer = ReadContact(root.At("dcc:customer"));
  for (const XmlElement* each : root.At("dcc:statements").All("dcc:statement")) {
    const std::string kind = each->Attribute("refType");
    const std::string text = ContentOf(*each, "dcc:declaration");
    if (kind == kDecisionRule) data.decision_rule = text == kNoRule ? "none" : kIso14253;
    if (kind == kDoubt) certificate.doubts.push_back(text);
    if (kind == kRemark) certificate.remarks.push_back(text);
  }
}

Series ReadSeries(const XmlElement& result, Certificate& certificate) {
  Series series;
  series.name = ContentOf(result, "dcc:name");
  series.words = ContentOf(result, "dcc:description");
  for (const XmlElement* each : result.At("dcc:data").At("dcc:list").All("dcc:quantity")) {
    const XmlElement& list = each->At("si:realListXMLList");
    const auto values = NumbersOf(list.At("si:valueXMLList"));
    if (each->Attribute("refType") == kPositions) {
      for (const std::string& unit : UnitsOf(list)) {
        if (unit != "m") throw InputError(fmt::format("line {}: is not in m", list.line));
      }
      series.positions = values;
      continue;
    }
    series.values = values;
    const auto units = UnitsOf(list);
    if (!units.empty()) series.unit = units.front();
    if (const XmlElement* labels = list.Find("si:labelXMLList")) series.labels = WordsOf(*labels);
    const XmlElement* expanded = list.Find("si:expandedUncXMLList");
    if (expanded == nullptr) continue;
    series.U95 = NumbersOf(expanded->At("si:uncertaintyXMLList"));
    const auto factors = NumbersOf(expanded->At("si:coverageFactorXMLList"));
    if (!factors.empty()) certificate.coverage = factors.front();
  }
  return series;
}

Joint ReadJoint(const XmlElement& result) {
  Joint joint;
  joint.words = ContentOf(result, "dcc:description");
  const XmlElement& list = result.At("dcc:data").At("dcc:quantity").At("si:realListXMLList");
  joint.names = WordsOf(list.At("si:labelXMLList"));
  joint.values = NumbersOf(list.At("si:valueXMLList"));
  joint.units = UnitsOf(list);
  const XmlElement& matrix = list.At("si:ellipsoidalRegionXMLList").At("si:covarianceMatrix");
  for (const XmlElement* column : matrix.All("si:column")) {
    for (const XmlElement* each : column->All("si:covariance")) {
      joint.covariance.push_back(NumberOf(each->At("si:value")));
    }
  }
  if (joint.covariance.size() != joint.names.size() * joint.names.size()) {
    throw InputError(fmt::format("line {}: the covariance has {} numbers for {} parameters",
                                 matrix.line, joint.covariance.size(), joint.names.size()));
  }
  return joint;
}

Conformity ReadConformity(const XmlElement& meta) {
  Conformity read;
  read.name = ContentOf(meta, "dcc:name");
  read.status = meta.TextOf("dcc:conformity");
  for (const XmlElement* each : meta.At("dcc:data").All("dcc:quantity")) {
    const XmlElement& real = each->At("si:real");
    read.unit = OwnUnit(real.TextOf("si:unit"), real.line);
    const double number = NumberOf(real.At("si:value"));
    (ContentOf(*each, "dcc:name") == "limit" ? read.limit : read.value) = number;
    if (const XmlElement* unc = real.Find("si:expandedUnc")) {
      read.U95 = NumberOf(unc->At("si:uncertainty"));
    }
  }
  return read;
}

void ReadResults(const XmlElement& measured, Certificate& certificate) {
  Administration& data = certificate.administration;
  certificate.title = ContentOf(measured, "dcc:name");
  for (const XmlElement* each : measured.At("dcc:usedMethods").All("dcc:usedMethod")) {
    certificate.methods.push_back(ContentOf(*each, "dcc:name"));
  }
  if (const XmlElement* list = measured.Find("dcc:measuringEquipments")) {
    for (const XmlElement* each : list->All("dcc:measuringEquipment")) {
      data.instruments.push_back(ReadInstrumentOf(*each));
    }
  }
  if (const XmlElement* list = measured.Find("dcc:influenceConditions")) {
    for (const XmlElement* each : list->All("dcc:influenceCondition")) {
      const XmlElement& content = each->At("dcc:data");
      if (each->Attribute("refType") == kTemperature) {
        certificate.temperature.push_back(
            NumberOf(content.At("dcc:quantity").At("si:real").At("si:value")));
      } else {
        data.conditions.push_back({ContentOf(*each, "dcc:name"), ContentOf(content, "dcc:text")});
      }
    }
  }
  for (const XmlElement* each : measured.At("dcc:results").All("dcc:result")) {
    if (each->At("dcc:data").Find("dcc:list") != nullptr) {
      certificate.results.push_back(ReadSeries(*each, certificate));
    } else {
      certificate.joint.push_back(ReadJoint(*each));
    }
  }
  if (const XmlElement* judged = measured.Find("dcc:measurementMetaData")) {
    for (const XmlElement* each : judged->All("dcc:metaData")) {
      certificate.conformities.push_back(ReadConformity(*each));
    }
  }
}

}  // namespace

Certificate ReadDcc(std::string_view text, const std::string& name) {
  const XmlElement root = ParseXml(text, name, DccNamespaces());
  if (root.name != "dcc:digitalCalibrationCertificate") {
    throw InputError(fmt::format("{}: is no DCC; its first element is <{}>", name, root.name));
  }
  try {
    Certificate certificate;
    ReadAdministrative(root.At("dcc:administrativeData"), certificate);
    ReadResults(root.At("dcc:measurementResults").At("dcc:measurementResult"), certificate);
    return certificate;
  } catch (const InputError& failure) {
    throw InputError(fmt::format("{}: {}; it is no certificate of abbe", name, failure.what()));
  }
}

}  // namespace abbe::certificate
