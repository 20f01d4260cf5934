// Characters of texts in UTF-8.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace graphdrl {

inline constexpr std::uint32_t kReplacement = 0xFFFD;  // the character that stands for what is none

struct Utf8Character {
  std::uint32_t code;  // kReplacement where the bytes are none
  std::size_t bytes;   // at least 1
};

// The character that begins there. REQUIRES: at < text.size().
Utf8Character utf8_at(std::string_view text, std::size_t at);

// The bytes of a character; empty where no character has this code, and for 0.
std::string utf8_of(std::uint32_t code);

bool is_utf8(std::string_view text);

// The same text, U+FFFD in place of every byte that belongs to no character.
std::string valid_utf8(std::string_view text);

// The same text, in place of every entity of HTML 4 ("&eacute;") and every number ("&#233;", "&#xE9;") its character.
// Others stay.
std::string without_entities(std::string_view text);

// Labels as a file can hold them, each made so by `fit`; none where they would no longer be all different.
std::vector<std::string> fitted_labels(std::span<const std::string> labels, std::string (*fit)(std::string_view));

}  // namespace graphdrl
