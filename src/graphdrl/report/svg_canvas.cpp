#include <fmt/format.h>

#include "graphdrl/io/picture.h"
#include "graphdrl/report/canvas.h"
#include "graphdrl/report/encoding.h"

namespace graphdrl {
namespace {

static_assert(sizeof(Colour) == 3);

constexpr double kShown = 0.9;  // of the time of a moving picture; the rest shows the finished one

std::string points_of(std::span<const Point> points) {
  std::string text;
  for (const Point& point : points) text += fmt::format("{}{:.6g},{:.6g}", text.empty() ? "" : " ", point.x, point.y);
  return text;
}

class SvgCanvas final : public Canvas {
 public:
  SvgCanvas(double width, double height, const std::string& title, const std::string& description,
            std::optional<double> seconds)
      : seconds_(seconds) {
    text_ = fmt::format(R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0:g}" height="{1:g}" )"
                        R"(viewBox="0 0 {0:g} {1:g}" role="img" font-family="system-ui, sans-serif">)"
                        "\n<title>{2}</title>\n<desc>{3}</desc>\n",
                        width, height, markup(title), markup(description));
  }

  void rectangle(Point corner, double width, double height, Colour fill) override {
    text_ += fmt::format("<rect x=\"{:.6g}\" y=\"{:.6g}\" width=\"{:.6g}\" height=\"{:.6g}\" fill=\"{}\"/>\n", corner.x,
                         corner.y, width, height, hex(fill));
  }

  void bitmap(const Bitmap& bitmap, Point corner, double width) override {
    text_ += fmt::format(
        "<image x=\"{:.6g}\" y=\"{:.6g}\" width=\"{:.6g}\" height=\"{:.6g}\" style=\"image-rendering: pixelated\" "
        "href=\"data:image/png;base64,{}\"/>\n",
        corner.x, corner.y, width, width * bitmap.height / bitmap.width,
        base64(format_png(bitmap.width, bitmap.height, 3, bitmap.pixels.data())));
  }

  void segments(std::span<const Segment> segments, Colour colour, double width) override {
    if (segments.empty()) return;
    text_ += fmt::format("<path stroke=\"{}\" stroke-width=\"{:.6g}\" fill=\"none\" d=\"", hex(colour), width);
    for (const Segment& segment : segments) {
      text_ += fmt::format("M{:.6g} {:.6g}L{:.6g} {:.6g}", segment.from.x, segment.from.y, segment.to.x, segment.to.y);
    }
    text_ += "\"/>\n";
  }

  void discs(std::span<const Point> centres, const Disc& disc) override {
    if (centres.empty()) return;
    text_ += fmt::format("<g fill=\"{}\"", disc.fill ? hex(*disc.fill) : "none");
    if (disc.stroke)
      text_ += fmt::format(" stroke=\"{}\" stroke-width=\"{:.6g}\"", hex(*disc.stroke), disc.stroke_width);
    text_ += ">\n";
    for (const Point& centre : centres) {
      text_ += fmt::format("<circle cx=\"{:.6g}\" cy=\"{:.6g}\" r=\"{:.6g}\"/>\n", centre.x, centre.y, disc.radius);
    }
    text_ += "</g>\n";
  }

  void polygon(std::span<const Point> corners, Colour fill) override {
    text_ += fmt::format("<polygon points=\"{}\" fill=\"{}\"/>\n", points_of(corners), hex(fill));
  }

  void text(Point at, std::string_view text, double size, Colour colour, Anchor anchor) override {
    const char* const anchors[] = {"start", "middle", "end"};
    text_ +=
        fmt::format("<text x=\"{:.6g}\" y=\"{:.6g}\" font-size=\"{:.6g}\" fill=\"{}\" text-anchor=\"{}\">{}</text>\n",
                    at.x, at.y, size, hex(colour), anchors[static_cast<int>(anchor)], markup(text));
  }

  void walk_part(std::span<const Point> points, Colour colour, double width, double begin, double end) override {
    std::string moving;
    if (seconds_) {
      // Drawn between its two times, and kept until the picture begins again.
      styles_ +=
          fmt::format("@keyframes w{0}{{0%,{1:.4g}%{{stroke-dashoffset:1.01}}{2:.4g}%,100%{{stroke-dashoffset:0}}}}\n",
                      parts_, 100 * kShown * begin, 100 * kShown * end);
      moving = fmt::format(" pathLength=\"1\" class=\"walk\" style=\"animation-name:w{}\"", parts_);
    }
    ++parts_;
    text_ += fmt::format(
        "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:.6g}\" stroke-linejoin=\"round\" "
        "stroke-linecap=\"{}\"{}/>\n",
        points_of(points), hex(colour), width, seconds_ ? "butt" : "round", moving);
  }

  void fade_in(double begin, double end, const std::function<void()>& draw) override {
    if (!seconds_) return draw();
    fade(0, 1, begin, end, draw);
  }

  void fade_out(double begin, double end, const std::function<void()>& draw) override {
    if (seconds_) fade(1, 0, begin, end, draw);
  }

  std::string finish() override {
    if (seconds_) {
      text_ += fmt::format(
          "<style>\n@media (prefers-reduced-motion: no-preference) {{\n.walk{{stroke-dasharray:1.01}}\n"
          ".walk,.fade{{animation:{:g}s linear infinite}}\n{}}}\n</style>\n",
          *seconds_, styles_);
    }
    return text_ + "</svg>\n";
  }

 private:
  // What `draw` draws goes from one opacity to another, and keeps that until the picture begins again.
  void fade(int from, int to, double begin, double end, const std::function<void()>& draw) {
    styles_ += fmt::format("@keyframes f{0}{{0%,{1:.4g}%{{opacity:{2}}}{3:.4g}%,100%{{opacity:{4}}}}}\n", fades_,
                           100 * kShown * begin, from, 100 * kShown * end, to);
    text_ += fmt::format("<g class=\"fade\" opacity=\"{}\" style=\"animation-name:f{}\">\n", to, fades_++);
    draw();
    text_ += "</g>\n";
  }

  std::string text_;
  std::optional<double> seconds_;
  std::string styles_;
  int parts_ = 0;
  int fades_ = 0;
};

}  // namespace

std::unique_ptr<Canvas> make_svg_canvas(double width, double height, const std::string& title,
                                        const std::string& description, std::optional<double> seconds) {
  return std::make_unique<SvgCanvas>(width, height, title, description, seconds);
}

}  // namespace graphdrl
