#include "graphdrl/io/checksum.h"

#include <fmt/format.h>

#include <boost/crc.hpp>

namespace graphdrl {

std::uint32_t crc32c(std::initializer_list<std::string_view> parts) {
  boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true> crc;
  for (const std::string_view part : parts) crc.process_bytes(part.data(), part.size());
  return crc.checksum();
}

std::string crc32c_text(std::initializer_list<std::string_view> parts) {
  return fmt::format("{:08x}", crc32c(parts));
}

}  // namespace graphdrl
