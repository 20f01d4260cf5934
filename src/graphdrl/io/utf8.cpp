#include "graphdrl/io/utf8.h"

#include <boost/locale/utf.hpp>
#include <iterator>
#include <unordered_set>

namespace graphdrl {
namespace {

using Traits = boost::locale::utf::utf_traits<char>;

}  // namespace

Utf8Character utf8_at(std::string_view text, std::size_t at) {
  const char* const begin = text.data() + at;
  const char* next = begin;
  const auto code = Traits::decode(next, text.data() + text.size());
  if (!boost::locale::utf::is_valid_codepoint(code)) return {kReplacement, 1};
  return {code, static_cast<std::size_t>(next - begin)};
}

std::string utf8_of(std::uint32_t code) {
  std::string text;
  if (code == 0) return text;
  if (boost::locale::utf::is_valid_codepoint(code)) Traits::encode(code, std::back_inserter(text));
  return text;
}

bool is_utf8(std::string_view text) {
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    if (!boost::locale::utf::is_valid_codepoint(Traits::decode(at, end))) return false;
  }
  return true;
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

std::vector<std::string> fitted_labels(std::span<const std::string> labels, std::string (*fit)(std::string_view)) {
  std::vector<std::string> fitted;
  for (const std::string& label : labels) fitted.push_back(fit(label));
  const std::unordered_set<std::string_view> different(fitted.begin(), fitted.end());
  if (different.size() != fitted.size()) fitted.clear();
  return fitted;
}

}  // namespace graphdrl
