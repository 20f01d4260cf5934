#include "graphdrl/report/colour.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace graphdrl {
namespace {

// In OKLCH: lightness, chroma, and the hue in degrees.
constexpr double kFirstLightness = 0.36;
constexpr double kLastLightness = 0.83;
constexpr double kChroma = 0.15;
constexpr double kFirstHue = 295;
constexpr double kLastHue = 100;

// One channel of sRGB from its linear value [IEC 61966-2-1].
std::uint8_t encoded(double linear) {
  linear = std::clamp(linear, 0.0, 1.0);
  const double value = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * value));
}

// Linear sRGB [Ottosson 2020, bottosson.github.io/posts/oklab].
struct Linear {
  double red;
  double green;
  double blue;
  bool shown() const { return std::min({red, green, blue}) >= 0 && std::max({red, green, blue}) <= 1; }
};

Linear linear_of(double lightness, double chroma, double hue) {
  const double a = chroma * std::cos(hue * std::numbers::pi / 180);
  const double b = chroma * std::sin(hue * std::numbers::pi / 180);
  const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
  const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
  const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

}  // namespace

std::string hex(Colour colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour.red, colour.green, colour.blue);
}

Colour colour_of_share(double share) {
  share = std::clamp(share, 0.0, 1.0);
  const double lightness = std::lerp(kFirstLightness, kLastLightness, share);
  const double hue = std::lerp(kFirstHue, kLastHue, share);
  // As much chroma as a screen shows.
  double chroma = kChroma;
  while (!linear_of(lightness, chroma, hue).shown() && chroma > 0) chroma -= 0.005;
  const Linear linear = linear_of(lightness, std::max(chroma, 0.0), hue);
  return {encoded(linear.red), encoded(linear.green), encoded(linear.blue)};
}

}  // namespace graphdrl
