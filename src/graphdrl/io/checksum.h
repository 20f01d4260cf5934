// Checksums of files: they find accidents, not malice.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

namespace graphdrl {

// What documents and safetensors files call theirs.
inline constexpr const char* kChecksumKey = "xxh3_64";

// XXH3 of 64 bits, seed 0, of the parts one after the other, as 16 hexadecimal digits [github.com/Cyan4973/xxHash]. It
// takes 0.017 s for 100 MB where Boost's CRC-32C takes 0.32 s.
std::string checksum(std::initializer_list<std::string_view> parts);

}  // namespace graphdrl
