// A build without libxml2.
#include "certificate/xml.h"
#include "failure/failure.h"

namespace abbe::certificate {
namespace {

[[noreturn]] void Refuse() {
  throw InputError(
      "this abbe was built without libxml2 and writes no certificates; install libxml2-dev and "
      "build it again");
}

}  // namespace

std::string XmlText(const XmlElement&, const std::vector<XmlNamespace>&) { Refuse(); }

XmlElement ParseXml(std::string_view, const std::string&, const std::vector<XmlNamespace>&) {
  Refuse();
}

}  // namespace abbe::certificate
