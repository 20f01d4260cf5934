// Bytes as letters.
#pragma once

#include <string>

namespace graphdrl {

// Base64 with padding [RFC 4648, section 4].
std::string base64(const std::string& bytes);

}  // namespace graphdrl
