#include "certificate/xml.h"

#include <fmt/format.h>
#include <libxml/parser.h>
#include <libxml/tree.h>
#include <libxml/xmlerror.h>

#include <limits>
#include <map>
#include <memory>

#include "failure/failure.h"

namespace abbe::certificate {
namespace {

struct FreeDocument {
  void operator()(xmlDoc* document) const { xmlFreeDoc(document); }
};
using DocumentPointer = std::unique_ptr<xmlDoc, FreeDocument>;
using Spaces = std::map<std::string, xmlNs*, std::less<>>;

const xmlChar* Chars(const std::string& text) {
  return reinterpret_cast<const xmlChar*>(text.c_str());
}

std::string Text(const xmlChar* chars) {
  return chars == nullptr ? std::string() : reinterpret_cast<const char*>(chars);
}

// "dcc:name" -> {"dcc", "name"}.
std::pair<std::string, std::string> Split(const std::string& name) {
  const auto colon = name.find(':');
  if (colon == std::string::npos) return {"", name};
  return {name.substr(0, colon), name.substr(colon + 1)};
}

xmlNode* NodeOf(const XmlElement& element, xmlDoc* document, const Spaces& spaces) {
  const auto [prefix, name] = Split(element.name);
  const auto space = spaces.find(prefix);
  xmlNode* node = xmlNewDocNode(document, space == spaces.end() ? nullptr : space->second,
                                Chars(name), nullptr);
  for (const auto& [key, value] : element.attributes) {
    const auto [of, attribute] = Split(key);
    // An attribute without a prefix is in no namespace, not in the default one.
    if (of.empty()) {
      xmlNewProp(node, Chars(attribute), Chars(value));
    } else {
      xmlNewNsProp(node, spaces.at(of), Chars(attribute), Chars(value));
    }
  }
  if (!element.text.empty()) xmlAddChild(node, xmlNewDocText(document, Chars(element.text)));
  for (const XmlElement& child : element.children) {
    xmlAddChild(node, NodeOf(child, document, spaces));
  }
  return node;
}

std::string QualifiedName(const xmlNs* space, const xmlChar* name,
                          const std::vector<XmlNamespace>& namespaces) {
  const std::string uri = space == nullptr ? "" : Text(space->href);
  for (const XmlNamespace& each : namespaces) {
    if (each.uri == uri) return each.prefix.empty() ? Text(name) : each.prefix + ":" + Text(name);
  }
  return Text(name);
}

XmlElement ElementOf(xmlNode* node, const std::vector<XmlNamespace>& namespaces) {
  XmlElement element(QualifiedName(node->ns, node->name, namespaces));
  element.line = xmlGetLineNo(node);
  for (const xmlAttr* each = node->properties; each != nullptr; each = each->next) {
    xmlChar* value = xmlNodeListGetString(node->doc, each->children, 1);
    element.Set(QualifiedName(each->ns, each->name, namespaces), Text(value));
    xmlFree(value);
  }
  for (xmlNode* child = node->children; child != nullptr; child = child->next) {
    if (child->type == XML_ELEMENT_NODE) element.Add(ElementOf(child, namespaces));
    if (child->type == XML_TEXT_NODE || child->type == XML_CDATA_SECTION_NODE) {
      element.text += Text(child->content);
    }
  }
  if (!element.children.empty()) element.text.clear();  // blanks between elements
  return element;
}

}  // namespace

std::string XmlText(const XmlElement& root, const std::vector<XmlNamespace>& namespaces) {
  const DocumentPointer document(xmlNewDoc(Chars("1.0")));
  // The namespaces belong to the root, which is made before its children know them.
  xmlNode* holder = xmlNewDocNode(document.get(), nullptr, Chars(Split(root.name).second), nullptr);
  xmlDocSetRootElement(document.get(), holder);
  Spaces spaces;
  for (const XmlNamespace& each : namespaces) {
    spaces[each.prefix] =
        xmlNewNs(holder, Chars(each.uri), each.prefix.empty() ? nullptr : Chars(each.prefix));
  }
  xmlNode* made = NodeOf(root, document.get(), spaces);
  xmlSetNs(holder, made->ns);
  // Its attributes and children move to the holder.
  for (const auto& [key, value] : root.attributes) {
    const auto [of, attribute] = Split(key);
    xmlNewNsProp(holder, of.empty() ? nullptr : spaces.at(of), Chars(attribute), Chars(value));
  }
  while (made->children != nullptr) {
    xmlNode* child = made->children;
    xmlUnlinkNode(child);
    xmlAddChild(holder, child);
  }
  xmlFreeNode(made);
  // A covariance has ten thousands of lines: one blank for each depth.
  xmlTreeIndentString = " ";
  xmlChar* bytes = nullptr;
  int size = 0;
  xmlDocDumpFormatMemoryEnc(document.get(), &bytes, &size, "UTF-8", 1);
  std::string text(reinterpret_cast<const char*>(bytes), size);
  xmlFree(bytes);
  return text;
}

XmlElement ParseXml(std::string_view text, const std::string& name,
                    const std::vector<XmlNamespace>& namespaces) {
  if (text.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
    throw InputError(fmt::format("{}: is larger than 2 GiB; it is no certificate", name));
  }
  xmlResetLastError();
  const DocumentPointer document(
      xmlReadMemory(text.data(), static_cast<int>(text.size()), name.c_str(), nullptr,
                    XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING));
  xmlNode* root = document == nullptr ? nullptr : xmlDocGetRootElement(document.get());
  if (root == nullptr) {
    const xmlError* error = xmlGetLastError();
    std::string why = error == nullptr || error->message == nullptr ? "no element" : error->message;
    for (char& each : why) each = each == '\n' ? ' ' : each;
    while (!why.empty() && why.back() == ' ') why.pop_back();
    throw InputError(
        fmt::format("{}:{}: is not XML: {}", name, error == nullptr ? 1 : error->line, why));
  }
  if (xmlGetIntSubset(document.get()) != nullptr) {
    throw InputError(fmt::format("{}: has a DOCTYPE, which no certificate has", name));
  }
  return ElementOf(root, namespaces);
}

}  // namespace abbe::certificate
