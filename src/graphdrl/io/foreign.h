// Files that are known, and cannot be read: what they look like, and what to do.
#pragma once

#include <string>
#include <string_view>

namespace graphdrl {

// Whether a text is of a format that is known by its content and not read.
bool is_foreign(std::string_view text);

// Throws Error, naming `source`: what the text looks like, and what to do. Also of one that nothing is known about.
[[noreturn]] void refuse_foreign(std::string_view text, const std::string& source);

}  // namespace graphdrl
