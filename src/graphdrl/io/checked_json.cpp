#include "graphdrl/io/checked_json.h"

#include <nlohmann/json.hpp>

#include "graphdrl/base/error.h"
#include "graphdrl/base/note.h"
#include "graphdrl/io/checksum.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/json.h"

namespace graphdrl {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr const char* kDocumentLayoutKey = "layout";
constexpr int kDocumentLayout = 2;  // since it there is a checksum; documents before it have no layout
constexpr auto kReplace = OrderedJson::error_handler_t::replace;

std::string sum_of(const OrderedJson& object) {
  return checksum({nlohmann::json(object).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)});
}

}  // namespace

void write_checked_json(const std::filesystem::path& path, OrderedJson object) {
  object[kDocumentLayoutKey] = kDocumentLayout;
  object[kChecksumKey] = sum_of(object);
  write_file(path, object.dump(2, ' ', false, kReplace) + '\n');
}

OrderedJson read_checked_json(const std::filesystem::path& path) {
  const std::string source = path.string();
  const std::string text = read_file(path);
  require_shallow_json(text, source);
  OrderedJson object = OrderedJson::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!object.is_object()) throw Error({.what = "not a whole document", .expected = "a JSON object", .where = source});
  if (!take_checksum(object, source)) {
    note(source + ": no checksum: whether the file is undamaged cannot be told");
  }
  return object;
}

bool take_checksum(OrderedJson& object, const std::string& source) {
  const auto found = object.find(kChecksumKey);
  if (found == object.end() && !object.contains(kDocumentLayoutKey)) return false;
  const OrderedJson expected = found == object.end() ? OrderedJson() : *found;
  object.erase(kChecksumKey);
  if (expected != sum_of(object)) {
    throw Error({.what = "the file is damaged: its checksum is not that of its content", .where = source});
  }
  if (object.value(kDocumentLayoutKey, 0) != kDocumentLayout) {
    throw Error({.what = "a document of another version of graphdrl", .where = source});
  }
  object.erase(kDocumentLayoutKey);
  return true;
}

}  // namespace graphdrl
