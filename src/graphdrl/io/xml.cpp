#include "graphdrl/io/xml.h"

#include <fmt/format.h>

#include <new>

#include "graphdrl/base/error.h"
#include "graphdrl/io/utf8.h"

namespace graphdrl {

XmlFile::XmlFile(std::string_view text, const std::string& source) : text_(text), source_(source) {
  const pugi::xml_parse_result result =
      document_.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
  if (result) return;
  if (result.status == pugi::status_out_of_memory) throw std::bad_alloc();
  throw Error(
      {.what = fmt::format("XML that is not well formed ({})", result.description()), .where = place(result.offset)});
}

void XmlFile::fail(pugi::xml_node at, const std::string& what, const std::string& expected) const {
  throw Error({.what = what, .expected = expected, .where = place(at)});
}

std::vector<Attribute> XmlKeys::defaults() const {
  std::vector<Attribute> attributes;
  for (const auto& [id, key] : keys_) {
    if (key.fallback) attributes.push_back({key.name, key.fallback.text().get()});
  }
  return attributes;
}

void XmlKeys::append(const char* id, const char* value, std::vector<Attribute>& attributes) const {
  const auto key = keys_.find(id);
  if (key != keys_.end()) attributes.push_back({key->second.name, value});
}

bool is_xml_with(std::string_view text, std::string_view element) {
  constexpr std::size_t kLooked = 4096;  // comments may stand before it
  const std::size_t begin = text.find_first_not_of(" \t\r\n");
  if (begin == std::string_view::npos || text[begin] != '<') return false;
  return text.substr(0, kLooked).find(element) != std::string_view::npos;
}

std::string_view local_name(pugi::xml_node node) {
  const std::string_view name = node.name();
  return name.substr(name.find(':') + 1);  // npos + 1 is 0
}

std::string xml_text(std::string_view text) {
  constexpr std::uint32_t kPictures = 0x2400;  // of control characters
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    auto [code, bytes] = utf8_at(text, at);
    at += bytes;
    const bool control = code < ' ' && code != '\t' && code != '\n' && code != '\r';
    if (control) code += kPictures;
    result += utf8_of(code == 0xFFFE || code == 0xFFFF ? kReplacement : code);
  }
  return result;
}

}  // namespace graphdrl
