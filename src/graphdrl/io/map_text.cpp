#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <boost/locale/encoding_utf.hpp>
#include <cstdint>
#include <new>

#include "graphdrl/base/error.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/utf8.h"

namespace graphdrl {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // spreadsheets begin UTF-8 with it
constexpr std::size_t kMostUnpacked = std::size_t{1} << 30;
constexpr std::size_t kUnpackedOfAnyFile = std::size_t{1} << 24;
constexpr std::size_t kUnpackedPerByte = 100;  // text of maps shrinks to a tenth, blank maps to less

struct Archive {
  std::string_view begin;
  const char* what;
};
constexpr Archive kOtherArchives[] = {{"PK\x03\x04", "a ZIP archive, or a spreadsheet"},
                                      {"BZh", "a file packed by bzip2"},
                                      {{"\xFD\x37zXZ\0", 6}, "a file packed by xz"},
                                      {"\x28\xB5\x2F\xFD", "a file packed by zstd"}};

// Some gzip files one after the other are one, too.
std::string gunzipped(std::string_view packed, const std::string& source) {
  constexpr int kGzipOnly = 16 + MAX_WBITS;
  z_stream stream{};
  if (inflateInit2(&stream, kGzipOnly) != Z_OK) throw std::bad_alloc();
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));  // zlib does not write there
  stream.avail_in = static_cast<uInt>(packed.size());
  std::string text;
  std::array<char, 65'536> block;
  int result = Z_OK;
  const std::size_t most = std::min(kMostUnpacked, std::max(kUnpackedOfAnyFile, kUnpackedPerByte * packed.size()));
  while (result == Z_OK && text.size() <= most) {
    stream.next_out = reinterpret_cast<Bytef*>(block.data());
    stream.avail_out = block.size();
    result = inflate(&stream, Z_NO_FLUSH);
    text.append(block.data(), block.size() - stream.avail_out);
    if (result == Z_STREAM_END && stream.avail_in > 0) result = inflateReset(&stream);
  }
  inflateEnd(&stream);
  if (text.size() > most) {
    throw Error({.what = "a gzipped file that is too large for its size",
                 .expected = fmt::format("at most {} bytes unpacked, or the file unpacked by gunzip", most),
                 .where = source});
  }
  if (result == Z_MEM_ERROR) throw std::bad_alloc();
  if (result != Z_STREAM_END) {
    throw Error({.what = "a gzipped file that is damaged or not whole", .where = source});
  }
  return text;
}

std::string unpacked(std::string bytes, const std::string& source) {
  for (const Archive& archive : kOtherArchives) {
    if (!bytes.starts_with(archive.begin)) continue;
    throw Error({.what = archive.what, .expected = "the file in it, unpacked or gzipped", .where = source});
  }
  if (bytes.starts_with("\x1F\x8B")) return gunzipped(bytes, source);
  return bytes;
}

std::string utf8_of_utf16(std::string_view bytes, bool big_end_first, const std::string& source) {
  std::u16string units;
  for (std::size_t at = 0; at + 1 < bytes.size(); at += 2) {
    const auto one = static_cast<std::uint8_t>(bytes[at]);
    const auto other = static_cast<std::uint8_t>(bytes[at + 1]);
    units += static_cast<char16_t>(big_end_first ? one << 8 | other : other << 8 | one);
  }
  try {
    namespace conv = boost::locale::conv;
    return conv::utf_to_utf<char>(units.data(), units.data() + units.size(), conv::stop);
  } catch (const boost::locale::conv::conversion_error&) {
    throw Error({.what = "a text that is not UTF-16, though it begins so", .where = source});
  }
}

// The characters of Windows-1252 in place of Latin-1's second set of control characters.
constexpr std::array<std::uint16_t, 32> kWindows = {0x20AC, 0x81,   0x201A, 0x192,  0x201E, 0x2026, 0x2020, 0x2021,
                                                    0x2C6,  0x2030, 0x160,  0x2039, 0x152,  0x8D,   0x17D,  0x8F,
                                                    0x90,   0x2018, 0x2019, 0x201C, 0x201D, 0x2022, 0x2013, 0x2014,
                                                    0x2DC,  0x2122, 0x161,  0x203A, 0x153,  0x9D,   0x17E,  0x178};

std::string utf8_of_latin1(std::string_view bytes) {
  std::string text;
  for (const char c : bytes) {
    const auto code = static_cast<std::uint8_t>(c);
    if (code < 0x80) {
      text += c;
    } else {
      text += utf8_of(code < 0xA0 ? kWindows[code - 0x80] : code);
    }
  }
  return text;
}

// Whether the declaration of XML says so.
bool declares_latin1(std::string_view text) {
  std::string begin(text.substr(0, std::min(text.find("?>"), std::size_t{200})));
  if (!begin.starts_with("<?xml")) return false;
  std::transform(begin.begin(), begin.end(), begin.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? c + 32 : c; });
  return begin.find("\"iso-8859-1\"") != std::string::npos || begin.find("\"windows-1252\"") != std::string::npos ||
         begin.find("'iso-8859-1'") != std::string::npos;
}

void end_lines_alike(std::string& text) {
  std::size_t to = 0;
  for (std::size_t from = 0; from < text.size(); ++from) {
    const bool first_of_two = text[from] == '\r' && from + 1 < text.size() && text[from + 1] == '\n';
    if (!first_of_two) text[to++] = text[from] == '\r' ? '\n' : text[from];
  }
  text.resize(to);
}

}  // namespace

std::string map_text(std::string bytes, const std::string& source,
                     const std::function<void(const std::string&)>& note) {
  std::string text = unpacked(std::move(bytes), source);
  if (is_png(text) || is_netpbm(text) || is_numpy(text)) return text;
  if (text.starts_with(kByteOrderMark)) {
    text.erase(0, kByteOrderMark.size());
  } else if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
    text = utf8_of_utf16(std::string_view(text).substr(2), text.front() == '\xFE', source);
  } else if (text.size() > 1 && (text[0] == '\0') != (text[1] == '\0')) {
    text = utf8_of_utf16(text, text[0] == '\0', source);
  }
  const bool declared = declares_latin1(text);
  if (declared || !is_utf8(text)) {
    if (!declared && note) note(fmt::format("{}: not UTF-8, so read as Latin-1 (Windows-1252)", source));
    text = utf8_of_latin1(text);
  }
  if (text.find('\r') != std::string::npos) end_lines_alike(text);
  return text;
}

}  // namespace graphdrl
