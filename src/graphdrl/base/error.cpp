#include "graphdrl/base/error.h"

#include <fmt/format.h>

namespace graphdrl {
namespace {

std::string one_line(const ErrorParts& parts) {
  std::string line;
  if (!parts.where.empty()) line += parts.where + ": ";
  line += parts.what;
  if (!parts.expected.empty()) line += ": expected " + parts.expected;
  if (!parts.got.empty()) line += (parts.expected.empty() ? ": got " : ", got ") + parts.got;
  return escaped(line);
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string result;
  int rest = 0;  // bytes that a character of UTF-8 still has
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool continues = rest > 0 && byte >= 0x80 && byte < 0xC0;
    rest = continues ? rest - 1 : byte >= 0xF0 ? 3 : byte >= 0xE0 ? 2 : byte >= 0xC0 ? 1 : 0;
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : 0);
    if (byte < 0x20 || byte == 0x7f || (byte >= 0x80 && byte < 0xA0 && !continues)) {
      result += fmt::format("\\x{:02x}", byte);
    } else if (byte == 0xC2 && next >= 0x80 && next < 0xA0) {  // the second set of control characters, in UTF-8
      result += fmt::format("\\x{:02x}", next);
      ++i;
      rest = 0;
    } else {
      result += text[i];
    }
  }
  return result;
}

Error::Error(const ErrorParts& parts) : std::runtime_error(one_line(parts)) {}

std::string in_quotes(std::string_view text, std::size_t max_length) {
  const bool cut = text.size() > max_length;
  return fmt::format("'{}{}'", escaped(text.substr(0, max_length)), cut ? "…" : "");
}

std::string decimal(double value) {
  return fmt::format("{:.15g}", value);
}

}  // namespace graphdrl
