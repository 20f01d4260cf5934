// Bytes and texts as files of text can hold them.
#pragma once

#include <string>
#include <string_view>

namespace graphdrl {

// Base64 with padding [RFC 4648, section 4].
std::string base64(const std::string& bytes);

// For texts and attributes of HTML and XML: valid UTF-8, with spaces for control characters.
std::string markup(std::string_view text);

}  // namespace graphdrl
