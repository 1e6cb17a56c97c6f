// XML text of a tree and back, by libxml2, which is used in xml.cpp and nowhere else. For use within
// certificate/.
//
// A reader takes no DOCTYPE (and so no entities), and never the network. Failure: InputError with
// the name of the file and the line; for a build without libxml2.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "certificate/xml_element.h"

namespace abbe::certificate {

struct XmlNamespace {
  std::string prefix, uri;  // no prefix: the default
};

// The document, in UTF-8.
std::string XmlText(const XmlElement& root, const std::vector<XmlNamespace>& namespaces);

// Names of other namespaces keep none; `name` stands for the file in messages.
XmlElement ParseXml(std::string_view text, const std::string& name,
                    const std::vector<XmlNamespace>& namespaces);

}  // namespace abbe::certificate
