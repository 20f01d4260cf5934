// What the readers and writers of XML share.
#pragma once

#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "graphdrl/io/attributes.h"
#include "graphdrl/io/text.h"

namespace graphdrl {

class XmlFile {
 public:
  // text: UTF-8, whatever its declaration says. Throws Error, naming `source` and the line, on XML that is not well
  // formed.
  XmlFile(std::string_view text, const std::string& source);

  // The element with this name that holds all others; none where there is no such one.
  pugi::xml_node root(const char* name) const { return document_.child(name); }
  // Where in the file an element stands: "file:line".
  std::string place(pugi::xml_node at) const { return at ? place(at.offset_debug()) : source_; }
  [[noreturn]] void fail(pugi::xml_node at, const std::string& what, const std::string& expected) const;

 private:
  std::string place(std::ptrdiff_t offset) const { return place_in(text_, static_cast<std::size_t>(offset), source_); }

  std::string_view text_;
  const std::string& source_;
  pugi::xml_document document_;
};

// The attributes of nodes or edges that a file declares.
class XmlKeys {
 public:
  // key: the element that declares one; its child `default`, where there is one, is the value that is not written.
  void add(pugi::xml_node key, const char* name) {
    keys_[key.attribute("id").value()] = {key.attribute(name).value(), key.child("default")};
  }
  std::vector<Attribute> defaults() const;
  // Appends what is written under an id.
  void append(const char* id, const char* value, std::vector<Attribute>& attributes) const;

 private:
  struct Key {
    std::string name;
    pugi::xml_node fallback;
  };
  std::unordered_map<std::string, Key> keys_;  // by id
};

// Whether a text is XML with this element near its begin: "<graphml".
bool is_xml_with(std::string_view text, std::string_view element);

// The name of an element without its prefix: "Geometry" of "y:Geometry".
std::string_view local_name(pugi::xml_node node);

// The same text as XML 1.0 can hold it: control characters as their pictures (U+2401 for U+0001), U+FFFD for what else
// is no character there.
std::string xml_text(std::string_view text);

}  // namespace graphdrl
