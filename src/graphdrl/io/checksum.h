// Checksums of files: they find accidents, not malice.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

namespace graphdrl {

// What documents and safetensors files call theirs.
inline constexpr const char* kChecksumKey = "xxh3_64";

// XXH3 of 64 bits, seed 0, of the parts one after the other, as 16 hexadecimal digits [github.com/Cyan4973/xxHash]. It
// reads memory as fast as the machine does; CRC-32C without its instruction took ten times as long.
std::string checksum(std::initializer_list<std::string_view> parts);

}  // namespace graphdrl
