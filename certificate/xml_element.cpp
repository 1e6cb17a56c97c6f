#include "certificate/xml_element.h"

#include <fmt/format.h>

#include <charconv>
#include <sstream>

#include "failure/failure.h"

namespace abbe::certificate {
namespace {

double Number(const std::string& word, long line) {
  double value = 0.0;
  const char* begin = word.data();
  if (word.starts_with('+')) ++begin;
  const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
  if (error == std::errc() && end == word.data() + word.size()) return value;
  throw InputError(fmt::format("line {}: \"{}\" is no number", line, word));
}

std::vector<std::string> Split(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

}  // namespace

XmlElement& XmlElement::AddText(std::string child, std::string child_text) {
  if (child_text.empty()) return *this;
  return Add(XmlElement(std::move(child), std::move(child_text)));
}

const XmlElement* XmlElement::Find(std::string_view child) const {
  for (const XmlElement& each : children) {
    if (each.name == child) return &each;
  }
  return nullptr;
}

const XmlElement& XmlElement::At(std::string_view child) const {
  if (const XmlElement* found = Find(child)) return *found;
  throw InputError(fmt::format("line {}: <{}> lacks <{}>", line, name, child));
}

std::vector<const XmlElement*> XmlElement::All(std::string_view child) const {
  std::vector<const XmlElement*> found;
  for (const XmlElement& each : children) {
    if (each.name == child) found.push_back(&each);
  }
  return found;
}

std::string XmlElement::TextOf(std::string_view child) const {
  const XmlElement* found = Find(child);
  return found == nullptr ? std::string() : found->text;
}

std::string XmlElement::Attribute(std::string_view attribute) const {
  for (const auto& [key, value] : attributes) {
    if (key == attribute) return value;
  }
  return {};
}

std::string NumbersText(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += fmt::format("{}{}", text.empty() ? "" : " ", value);
  return text;
}

std::vector<double> NumbersOf(const XmlElement& element) {
  std::vector<double> numbers;
  for (const std::string& word : Split(element.text)) {
    numbers.push_back(Number(word, element.line));
  }
  return numbers;
}

double NumberOf(const XmlElement& element) { return Number(element.text, element.line); }

std::string WordsText(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) {
    if (!text.empty()) text += ' ';
    for (const char each : word) {
      text += each == ' ' ? "%20" : each == '%' ? "%25" : std::string(1, each);
    }
  }
  return text;
}

std::vector<std::string> WordsOf(const XmlElement& element) {
  std::vector<std::string> words = Split(element.text);
  for (std::string& word : words) {
    std::string plain;
    for (std::size_t i = 0; i < word.size(); ++i) {
      const bool escaped = word[i] == '%' && i + 2 < word.size();
      plain += escaped ? (word.compare(i, 3, "%20") == 0 ? ' ' : '%') : word[i];
      if (escaped) i += 2;
    }
    word = plain;
  }
  return words;
}

}  // namespace abbe::certificate
