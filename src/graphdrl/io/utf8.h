// Characters of texts in UTF-8.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace graphdrl {

struct Utf8Character {
  std::uint32_t code;  // U+FFFD where the bytes are none
  std::size_t bytes;   // at least 1
};

// The character that begins there. REQUIRES: at < text.size().
Utf8Character utf8_at(std::string_view text, std::size_t at);

// The bytes of a character; empty where no character has this code.
std::string utf8_of(double code);

// The same text, U+FFFD in place of every byte that belongs to no character.
std::string valid_utf8(std::string_view text);

}  // namespace graphdrl
