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
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : 0);
    if (byte < 0x20 || byte == 0x7f) {
      result += fmt::format("\\x{:02x}", byte);
    } else if (byte == 0xC2 && next >= 0x80 && next < 0xA0) {  // the second set of control characters, in UTF-8
      result += fmt::format("\\x{:02x}", next);
      ++i;
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
