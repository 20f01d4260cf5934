// Checksums of files.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

namespace graphdrl {

// CRC-32C, Castagnoli's polynomial, of the parts one after the other [RFC 3720, section 12.1]. Finds every flipped bit.
std::uint32_t crc32c(std::initializer_list<std::string_view> parts);

// The same as eight hexadecimal digits, as files hold it.
std::string crc32c_text(std::initializer_list<std::string_view> parts);

}  // namespace graphdrl
