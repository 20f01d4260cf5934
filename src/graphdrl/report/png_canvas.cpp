#include <cairo.h>

#include <cmath>
#include <new>
#include <numbers>

#include "graphdrl/base/error.h"
#include "graphdrl/io/utf8.h"
#include "graphdrl/report/canvas.h"

namespace graphdrl {
namespace {

cairo_status_t append_bytes(void* closure, const unsigned char* data, unsigned int length) {
  try {
    static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), length);
  } catch (const std::bad_alloc&) {  // must not pass through C
    return CAIRO_STATUS_NO_MEMORY;
  }
  return CAIRO_STATUS_SUCCESS;
}

class PngCanvas final : public Canvas {
 public:
  PngCanvas(double width, double height)
      : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(std::ceil(width)),
                                            static_cast<int>(std::ceil(height))),
                 cairo_surface_destroy),
        context_(cairo_create(surface_.get()), cairo_destroy) {
    check(cairo_status(context_.get()));
    cairo_set_line_join(context_.get(), CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(context_.get(), CAIRO_LINE_CAP_ROUND);
    cairo_select_font_face(context_.get(), "sans-serif", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  }

  void rectangle(Point corner, double width, double height, Colour fill) override {
    set(fill);
    cairo_rectangle(context_.get(), corner.x, corner.y, width, height);
    cairo_fill(context_.get());
  }

  void bitmap(const Bitmap& bitmap, Point corner, double width) override {
    const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> image(
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, bitmap.width, bitmap.height), cairo_surface_destroy);
    check(cairo_surface_status(image.get()));
    unsigned char* const data = cairo_image_surface_get_data(image.get());
    const int stride = cairo_image_surface_get_stride(image.get());
    for (int y = 0; y < bitmap.height; ++y) {
      auto* const row = reinterpret_cast<std::uint32_t*>(data + static_cast<std::ptrdiff_t>(y) * stride);
      for (int x = 0; x < bitmap.width; ++x) {
        const Colour colour = bitmap.pixels[static_cast<std::size_t>(y) * bitmap.width + x];
        row[x] = std::uint32_t{colour.red} << 16 | std::uint32_t{colour.green} << 8 | colour.blue;
      }
    }
    cairo_surface_mark_dirty(image.get());
    cairo_save(context_.get());
    cairo_translate(context_.get(), corner.x, corner.y);
    cairo_scale(context_.get(), width / bitmap.width, width / bitmap.width);
    cairo_set_source_surface(context_.get(), image.get(), 0, 0);
    cairo_pattern_set_filter(cairo_get_source(context_.get()), CAIRO_FILTER_NEAREST);
    cairo_paint(context_.get());
    cairo_restore(context_.get());
  }

  void segments(std::span<const Segment> segments, Colour colour, double width) override {
    set(colour);
    cairo_set_line_width(context_.get(), width);
    for (const Segment& segment : segments) {
      cairo_move_to(context_.get(), segment.from.x, segment.from.y);
      cairo_line_to(context_.get(), segment.to.x, segment.to.y);
      cairo_stroke(context_.get());  // one by one: long paths are slow
    }
  }

  void discs(std::span<const Point> centres, const Disc& disc) override {
    for (const Point& centre : centres) {
      cairo_new_path(context_.get());
      cairo_arc(context_.get(), centre.x, centre.y, disc.radius, 0, 2 * std::numbers::pi);
      if (disc.fill) {
        set(*disc.fill);
        cairo_fill_preserve(context_.get());
      }
      if (disc.stroke) {
        set(*disc.stroke);
        cairo_set_line_width(context_.get(), disc.stroke_width);
        cairo_stroke_preserve(context_.get());
      }
    }
    cairo_new_path(context_.get());
  }

  void polygon(std::span<const Point> corners, Colour fill) override {
    set(fill);
    for (const Point& corner : corners) cairo_line_to(context_.get(), corner.x, corner.y);
    cairo_close_path(context_.get());
    cairo_fill(context_.get());
  }

  void text(Point at, std::string_view text, double size, Colour colour, Anchor anchor) override {
    const std::string shown = valid_utf8(text);
    set(colour);
    cairo_set_font_size(context_.get(), size);
    cairo_text_extents_t extents;
    cairo_text_extents(context_.get(), shown.c_str(), &extents);
    const double shift = anchor == Anchor::kStart ? 0 : anchor == Anchor::kEnd ? 1 : 0.5;
    cairo_move_to(context_.get(), at.x - shift * extents.x_advance, at.y);
    cairo_show_text(context_.get(), shown.c_str());
    cairo_new_path(context_.get());
  }

  void walk_part(std::span<const Point> points, Colour colour, double width, double /*begin*/,
                 double /*end*/) override {
    set(colour);
    cairo_set_line_width(context_.get(), width);
    for (const Point& point : points) cairo_line_to(context_.get(), point.x, point.y);
    cairo_stroke(context_.get());
  }

  void fade_in(double /*begin*/, double /*end*/, const std::function<void()>& draw) override { draw(); }
  void fade_out(double /*begin*/, double /*end*/, const std::function<void()>& /*draw*/) override {}

  std::string finish() override {
    check(cairo_status(context_.get()));
    std::string bytes;
    check(cairo_surface_write_to_png_stream(surface_.get(), append_bytes, &bytes));
    return bytes;
  }

  Bitmap pixels() const {
    check(cairo_status(context_.get()));
    cairo_surface_flush(surface_.get());
    Bitmap bitmap{.width = cairo_image_surface_get_width(surface_.get()),
                  .height = cairo_image_surface_get_height(surface_.get()),
                  .pixels = {}};
    const unsigned char* const data = cairo_image_surface_get_data(surface_.get());
    const int stride = cairo_image_surface_get_stride(surface_.get());
    for (int y = 0; y < bitmap.height; ++y) {
      const auto* const row = reinterpret_cast<const std::uint32_t*>(data + static_cast<std::ptrdiff_t>(y) * stride);
      for (int x = 0; x < bitmap.width; ++x) {
        const auto part = [&](int shift) { return static_cast<std::uint8_t>(row[x] >> shift & 255U); };
        bitmap.pixels.push_back({.red = part(16), .green = part(8), .blue = part(0)});
      }
    }
    return bitmap;
  }

 private:
  void set(Colour colour) {
    cairo_set_source_rgb(context_.get(), colour.red / 255.0, colour.green / 255.0, colour.blue / 255.0);
  }

  static void check(cairo_status_t status) {
    if (status == CAIRO_STATUS_SUCCESS) return;
    if (status == CAIRO_STATUS_NO_MEMORY) throw std::bad_alloc();
    throw Error({.what = std::string("the picture cannot be drawn (") + cairo_status_to_string(status) + ")"});
  }

  std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface_;
  std::unique_ptr<cairo_t, void (*)(cairo_t*)> context_;
};

}  // namespace

Bitmap draw_bitmap(double width, double height, const std::function<void(Canvas&)>& draw) {
  PngCanvas canvas(width, height);
  draw(canvas);
  return canvas.pixels();
}

std::unique_ptr<Canvas> make_png_canvas(double width, double height) {
  return std::make_unique<PngCanvas>(width, height);
}

}  // namespace graphdrl
