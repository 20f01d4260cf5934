// Characters that a text names: "&eacute;", "&#233;", "&#xE9;".
#pragma once

#include <string>
#include <string_view>

namespace graphdrl {

// The same text in UTF-8, in place of every entity of HTML 4 and every number its character. Others stay.
std::string without_entities(std::string_view text);

}  // namespace graphdrl
