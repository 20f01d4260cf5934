#include "graphdrl/io/safetensors.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>

#include "graphdrl/base/error.h"
#include "graphdrl/io/checksum.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/json.h"

namespace graphdrl {
namespace {

static_assert(std::endian::native == std::endian::little, "safetensors files are little-endian");

using Json = nlohmann::json;
constexpr const char* kMetadataKey = "__metadata__";

// Bytes per element; 0 for a type the format does not know.
std::size_t dtype_size(std::string_view dtype) {
  if (dtype == "F64" || dtype == "I64" || dtype == "U64") return 8;
  if (dtype == "F32" || dtype == "I32" || dtype == "U32") return 4;
  if (dtype == "F16" || dtype == "BF16" || dtype == "I16" || dtype == "U16") return 2;
  if (dtype == "I8" || dtype == "U8" || dtype == "BOOL") return 1;
  return 0;
}

[[noreturn]] void fail(const std::string& source, const std::string& what, const std::string& expected = "",
                       const std::string& got = "") {
  throw Error({.what = what, .expected = expected, .got = got, .where = source});
}

// Of a header without its checksum.
std::string checksum_of(const Json& header, std::string_view data) {
  return checksum({header.dump(), data});
}

// One array's line of the header, checked but for its neighbours.
Safetensors::Entry parse_entry(const std::string& source, const std::string& name, const Json& line,
                               std::size_t data_size) {
  const std::string tensor = "tensor " + in_quotes(name);
  if (!line.is_object() || !line.contains("dtype") || !line["dtype"].is_string() || !line.contains("shape") ||
      !line["shape"].is_array() || !line.contains("data_offsets") || !line["data_offsets"].is_array() ||
      line["data_offsets"].size() != 2) {
    fail(source, tensor + " is not described", "dtype, shape and two data_offsets");
  }
  Safetensors::Entry entry{.name = name, .dtype = line["dtype"], .shape = {}, .begin = 0, .end = 0};
  std::size_t size = dtype_size(entry.dtype);
  if (size == 0) fail(source, tensor + " has an unknown type", "F32, I64 and the like", in_quotes(entry.dtype));
  for (const Json& extent : line["shape"]) {
    if (!extent.is_number_unsigned()) fail(source, tensor + " has a strange shape", "whole numbers", shortened(extent));
    const auto value = extent.get<std::uint64_t>();
    if (value > INT64_MAX || __builtin_mul_overflow(size, value, &size)) {
      fail(source, tensor + " has a size that overflows");
    }
    entry.shape.push_back(static_cast<std::int64_t>(value));
  }
  const Json& offsets = line["data_offsets"];
  if (!offsets[0].is_number_unsigned() || !offsets[1].is_number_unsigned()) {
    fail(source, tensor + " has strange data_offsets", "whole numbers", shortened(offsets));
  }
  entry.begin = offsets[0].get<std::size_t>();
  entry.end = offsets[1].get<std::size_t>();
  if (entry.begin > entry.end || entry.end > data_size) {
    fail(source, tensor + " lies outside the file", fmt::format("offsets up to {}", data_size), shortened(offsets));
  }
  if (entry.end - entry.begin != size) {
    fail(source, tensor + " has the wrong length", fmt::format("{} bytes for {}", size, format_shape(entry.shape)),
         fmt::format("{}", entry.end - entry.begin));
  }
  return entry;
}

}  // namespace

std::string format_shape(const Shape& shape) {
  return fmt::format("[{}]", fmt::join(shape, ", "));
}

std::string format_safetensors(std::span<const TensorView> tensors, const Metadata& metadata) {
  nlohmann::ordered_json header;
  header[kMetadataKey] = metadata;
  std::string data;
  for (const TensorView& tensor : tensors) {
    const std::size_t begin = data.size();
    data.append(reinterpret_cast<const char*>(tensor.bytes.data()), tensor.bytes.size());
    header[tensor.name] = {{"dtype", tensor.dtype}, {"shape", tensor.shape}, {"data_offsets", {begin, data.size()}}};
  }
  header[kMetadataKey][kChecksumKey] = checksum_of(Json(header), data);
  std::string text = header.dump();
  text.append((8 - text.size() % 8) % 8, ' ');  // the data starts aligned
  const std::uint64_t length = text.size();
  std::string content(reinterpret_cast<const char*>(&length), sizeof length);
  content.reserve(content.size() + text.size() + data.size());
  return content += text += data;
}

void write_safetensors(const std::filesystem::path& path, std::span<const TensorView> tensors,
                       const Metadata& metadata) {
  write_file(path, format_safetensors(tensors, metadata));
}

Safetensors Safetensors::read(const std::filesystem::path& path) {
  return parse(read_file(path), path.string());
}

Safetensors Safetensors::parse(std::string content, const std::string& source) {
  std::uint64_t length = 0;
  if (content.size() < sizeof length) {
    fail(source, "not a safetensors file", "a header length of 8 bytes", fmt::format("{} bytes", content.size()));
  }
  std::memcpy(&length, content.data(), sizeof length);
  if (length > content.size() - sizeof length) {
    fail(source, "not a whole safetensors file", fmt::format("a header of {} bytes", length),
         fmt::format("{} bytes", content.size() - sizeof length));
  }
  const std::string_view text = std::string_view(content).substr(sizeof length, length);
  Json header = parse_json_or_discard(text);
  // A zero byte would end the text for the parser.
  if (!header.is_object() || text.find('\0') != std::string_view::npos)
    fail(source, "not a safetensors file", "a header in JSON");

  Safetensors file;
  file.source_ = source;
  file.data_begin_ = sizeof length + length;
  const std::size_t data_size = content.size() - file.data_begin_;
  for (const auto& [name, json] : header.items()) {
    if (name != kMetadataKey) {
      file.entries_.push_back(parse_entry(source, name, json, data_size));
      continue;
    }
    if (!json.is_object()) fail(source, "the metadata is not an object of texts");
    for (const auto& [key, value] : json.items()) {
      if (!value.is_string()) fail(source, "the metadata is not an object of texts");
      file.metadata_[key] = value;
    }
  }
  if (const auto expected = file.metadata_.extract(kChecksumKey)) {
    header[kMetadataKey].erase(kChecksumKey);
    if (expected.mapped() != checksum_of(header, std::string_view(content).substr(file.data_begin_))) {
      fail(source, "the file is damaged: its checksum is not that of its content");
    }
    file.has_checksum_ = true;
  }
  std::sort(file.entries_.begin(), file.entries_.end(),
            [](const Entry& a, const Entry& b) { return std::pair(a.begin, a.end) < std::pair(b.begin, b.end); });
  std::size_t position = 0;
  for (const Entry& entry : file.entries_) {
    if (entry.begin != position) {
      fail(source, "tensor " + in_quotes(entry.name) + " overlaps another or leaves a gap",
           fmt::format("data from {}", position), fmt::format("from {}", entry.begin));
    }
    position = entry.end;
  }
  if (position != data_size) {
    fail(source, "data that belongs to no tensor", fmt::format("{} bytes", position), fmt::format("{}", data_size));
  }
  file.content_ = std::move(content);
  return file;
}

void Safetensors::require_checksum() const {
  if (!has_checksum_) fail(source_, "the file is damaged: its checksum is missing");
}

const Safetensors::Entry& Safetensors::find(const std::string& name) const {
  for (const Entry& entry : entries_) {
    if (entry.name == name) return entry;
  }
  fail(source_, "tensor " + in_quotes(name) + " is missing");
}

std::span<const char> Safetensors::bytes_of(const std::string& name, std::string_view dtype, const Shape& shape) const {
  const Entry& entry = find(name);
  if (entry.dtype != dtype) {
    fail(source_, "tensor " + in_quotes(name) + " has the wrong type", std::string(dtype), entry.dtype);
  }
  if (entry.shape != shape) {
    fail(source_, "tensor " + in_quotes(name) + " has the wrong shape", format_shape(shape), format_shape(entry.shape));
  }
  return {content_.data() + data_begin_ + entry.begin, entry.end - entry.begin};
}

}  // namespace graphdrl
