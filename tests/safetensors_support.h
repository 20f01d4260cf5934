// Changed safetensors files, for tests of what is refused.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "graphdrl/io/checksum.h"
#include "graphdrl/io/safetensors.h"

namespace graphdrl {

// The content of a safetensors file, changed, with the checksum that belongs to it.
inline std::string with_checksum(const std::string& content) {
  const std::size_t header_end = sizeof(std::uint64_t) + *reinterpret_cast<const std::uint64_t*>(content.data());
  auto header =
      nlohmann::ordered_json::parse(content.substr(sizeof(std::uint64_t), header_end - sizeof(std::uint64_t)));
  Metadata metadata = header.at("__metadata__");
  metadata.erase(kChecksumKey);
  std::vector<TensorView> tensors;
  const std::string_view data = std::string_view(content).substr(header_end);
  for (const auto& [name, entry] : header.items()) {
    if (name == "__metadata__") continue;
    const std::size_t begin = entry["data_offsets"][0];
    const std::size_t end = entry["data_offsets"][1];
    TensorView view(name, entry["shape"], std::span<const char>(data.substr(begin, end - begin)));
    view.dtype = entry["dtype"].get_ref<const std::string&>();
    tensors.push_back(view);
  }
  return format_safetensors(tensors, metadata);
}

}  // namespace graphdrl
