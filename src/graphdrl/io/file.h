// Whole files in and out.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace graphdrl {

// The bytes of a file. Throws Error when it cannot be read.
std::string read_file(const std::filesystem::path& path);

// Replaces `path` with `content`, or leaves what was there: written beside it, synced, renamed. A link is followed.
// Throws Error, also where something stands there that is no file.
void write_file(const std::filesystem::path& path, std::string_view content);

// Creates `folder` and its parents where missing, and makes sure that files can be written there. Throws Error.
void prepare_folder(const std::filesystem::path& folder);

}  // namespace graphdrl
