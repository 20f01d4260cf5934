#include "graphdrl/io/utf8.h"

#include <boost/locale/utf.hpp>
#include <cmath>
#include <iterator>

namespace graphdrl {
namespace {

using Traits = boost::locale::utf::utf_traits<char>;

constexpr std::uint32_t kReplacement = 0xFFFD;

}  // namespace

Utf8Character utf8_at(std::string_view text, std::size_t at) {
  const char* const begin = text.data() + at;
  const char* next = begin;
  const auto code = Traits::decode(next, text.data() + text.size());
  if (!boost::locale::utf::is_valid_codepoint(code)) return {kReplacement, 1};
  return {code, static_cast<std::size_t>(next - begin)};
}

std::string utf8_of(double code) {
  std::string text;
  if (!(code >= 1 && code <= 0x10FFFF) || code != std::floor(code)) return text;
  const auto number = static_cast<boost::locale::utf::code_point>(code);
  if (boost::locale::utf::is_valid_codepoint(number)) Traits::encode(number, std::back_inserter(text));
  return text;
}

std::string valid_utf8(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const Utf8Character character = utf8_at(text, at);
    Traits::encode(character.code, std::back_inserter(result));
    at += character.bytes;
  }
  return result;
}

}  // namespace graphdrl
