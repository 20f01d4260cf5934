// Colours, and a scale of them that looks even.
#pragma once

#include <cstdint>
#include <string>

namespace graphdrl {

struct Colour {
  std::uint8_t red;
  std::uint8_t green;
  std::uint8_t blue;
  friend bool operator==(const Colour&, const Colour&) = default;
};

// "#rrggbb".
std::string hex(Colour colour);

// From violet over green to yellow, for a share in [0, 1]. Lightness rises evenly in OKLab [Ottosson 2020], so that the
// order can be seen without colours too; dark enough throughout to stand on white.
Colour colour_of_share(double share);

}  // namespace graphdrl
