// Safetensors files: named arrays behind a JSON header. Reading one never executes anything.
// Format: u64 header length, JSON header {name: {dtype, shape, data_offsets}, "__metadata__": {key: text}}, data;
// everything little-endian [github.com/huggingface/safetensors, "Format"]. Files written here have a checksum among the
// metadata: `xxh3_64`, of the header without it, its keys sorted and without spaces, and of the data behind it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace graphdrl {

using Shape = std::vector<std::int64_t>;

// The format's name for an element type: "F32" …
template <typename T>
inline constexpr std::string_view kDtypeOf{};
template <>
inline constexpr std::string_view kDtypeOf<float> = "F32";
template <>
inline constexpr std::string_view kDtypeOf<double> = "F64";
template <>
inline constexpr std::string_view kDtypeOf<std::int32_t> = "I32";
template <>
inline constexpr std::string_view kDtypeOf<std::int64_t> = "I64";
template <>
inline constexpr std::string_view kDtypeOf<char> = "U8";
template <>
inline constexpr std::string_view kDtypeOf<std::uint16_t> = "U16";
template <>
inline constexpr std::string_view kDtypeOf<std::uint64_t> = "U64";

// One array to write; the bytes stay the caller's.
struct TensorView {
  std::string name;
  std::string_view dtype;
  Shape shape;
  std::span<const std::byte> bytes;

  template <typename T>
  TensorView(std::string tensor_name, Shape tensor_shape, std::span<const T> values)
      : name(std::move(tensor_name)),
        dtype(kDtypeOf<T>),
        shape(std::move(tensor_shape)),
        bytes(std::as_bytes(values)) {}
};

using Metadata = std::map<std::string, std::string>;

// A file's content; tensors are stored in the order given.
std::string format_safetensors(std::span<const TensorView> tensors, const Metadata& metadata);
// Replaces `path` with it, whole or not at all. Throws Error.
void write_safetensors(const std::filesystem::path& path, std::span<const TensorView> tensors,
                       const Metadata& metadata);

// A file read whole and checked: every array lies inside the data, has the size its shape asks for, overlaps no other
// and leaves no gap; the checksum, if there is one, is right.
class Safetensors {
 public:
  struct Entry {
    std::string name;
    std::string dtype;
    Shape shape;
    std::size_t begin;  // bytes from the start of the data
    std::size_t end;
  };

  // Throws Error, naming the file, on anything that is not a whole safetensors file.
  static Safetensors read(const std::filesystem::path& path);
  static Safetensors parse(std::string content, const std::string& source);

  const std::vector<Entry>& entries() const { return entries_; }  // in order of position
  const Metadata& metadata() const { return metadata_; }          // without the checksum
  bool has_checksum() const { return has_checksum_; }
  // Throws Error where there is none.
  void require_checksum() const;
  const std::string& source() const { return source_; }

  // The shape of an array. Throws Error where the file holds none of that name.
  const Shape& shape_of(const std::string& name) const { return find(name).shape; }

  // A copy of one array. Throws Error where the file holds none of that name, type and shape.
  template <typename T>
  std::vector<T> get(const std::string& name, const Shape& shape) const {
    const std::span<const char> bytes = bytes_of(name, kDtypeOf<T>, shape);
    std::vector<T> values(bytes.size() / sizeof(T));
    std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(values.data()));
    return values;
  }

 private:
  const Entry& find(const std::string& name) const;
  std::span<const char> bytes_of(const std::string& name, std::string_view dtype, const Shape& shape) const;

  std::string source_;
  std::string content_;
  std::size_t data_begin_ = 0;
  std::vector<Entry> entries_;
  Metadata metadata_;
  bool has_checksum_ = false;
};

std::string format_shape(const Shape& shape);  // "[4, 7, 7]"

}  // namespace graphdrl
