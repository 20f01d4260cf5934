// JSON documents with a checksum inside, so that a damaged one is not taken for another.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace graphdrl {

// Writes an object and, as its last keys, `layout` and `xxh3_64`, which is of the object without it, its keys sorted
// and without spaces. Throws Error.
void write_checked_json(const std::filesystem::path& path, nlohmann::ordered_json object);

// Gives the object without these keys. Throws Error where there is none, and where the checksum is not its own. Notes
// that a document without a layout, which is an older one, has no checksum.
nlohmann::ordered_json read_checked_json(const std::filesystem::path& path);

// Takes these keys off a document that was read already; gives false where it has none of them. Throws Error where the
// checksum is not its own.
bool take_checksum(nlohmann::ordered_json& object, const std::string& source);

}  // namespace graphdrl
