// An XML document as a tree. For use within certificate/.
//
//   XmlElement name("dcc:name");
//   name.Add(XmlElement("dcc:content", "mill"));
//
// Names carry the prefix of the writer's table of namespaces ("dcc:name"; none for the default).
// An element has children or text, not both. Failure: InputError where a reader asks for an element
// or an attribute that is not there; it names the line.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abbe::certificate {

struct XmlElement {
  // An element, with a text or none.
  explicit XmlElement(std::string element_name, std::string element_text = {})
      : name(std::move(element_name)), text(std::move(element_text)) {}

  // Adds a child and returns this element.
  XmlElement& Add(XmlElement child) {
    children.push_back(std::move(child));
    return *this;
  }
  // The same with a text; an empty text adds nothing.
  XmlElement& AddText(std::string child, std::string child_text);
  // Adds an attribute and returns this element.
  XmlElement& Set(std::string attribute, std::string value) {
    attributes.emplace_back(std::move(attribute), std::move(value));
    return *this;
  }

  // The first child of that name, or null.
  const XmlElement* Find(std::string_view child) const;
  // The same, which must be there.
  const XmlElement& At(std::string_view child) const;
  // All children of that name, in order.
  std::vector<const XmlElement*> All(std::string_view child) const;
  // The text of a child; empty where there is none.
  std::string TextOf(std::string_view child) const;
  // Empty where there is none.
  std::string Attribute(std::string_view attribute) const;

  std::string name, text;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<XmlElement> children;
  long line = 0;  // of a document that was read
};

// Shortest decimals that read back the same, separated by blanks.
std::string NumbersText(const std::vector<double>& values);
// Failure: InputError with the line for what is no number.
std::vector<double> NumbersOf(const XmlElement& element);
// The same for one number.
double NumberOf(const XmlElement& element);

// Words without blanks and back: "%20" for a blank, "%25" for "%".
std::string WordsText(const std::vector<std::string>& words);
// The words of an element's text.
std::vector<std::string> WordsOf(const XmlElement& element);

}  // namespace abbe::certificate
