#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <span>

#include "graphdrl/base/error.h"
#include "graphdrl/io/file.h"
#include "graphdrl/io/picture.h"
#include "graphdrl/io/readers.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

constexpr double kOccupiedThreshold = 0.65;  // map_server's
constexpr double kFreeThreshold = 0.196;     // likewise
constexpr int kMostRawOccupancy = 100;
constexpr std::size_t kLargestYaml =
    65536;  // bytes: its values take hundreds of times as much, and such files are small

enum class Mode { kTrinary, kScale, kRaw };

struct Pixel {
  double level;  // 0 black to 255 white
  bool transparent;
};

// As map_server counts it: the mean of red, green and blue, and of alpha too in trinary mode.
Pixel pixel_of(std::span<const std::uint8_t> samples, Mode mode) {
  const bool alpha = samples.size() % 2 == 0;
  const bool colour = samples.size() >= 3;
  double sum = colour ? samples[0] + samples[1] + samples[2] : 3 * samples[0];
  double count = 3;
  if (alpha && mode == Mode::kTrinary) {
    sum += samples.back();
    ++count;
  }
  return {.level = sum / count, .transparent = alpha && samples.back() < 255};
}

class RosMapReader {
 public:
  RosMapReader(std::string_view text, const std::string& source, const MapOptions& options)
      : source_(source), options_(options) {
    if (text.size() > kLargestYaml) {
      throw Error({.what = "a map of ROS that is too large",
                   .expected = fmt::format("at most {} bytes", kLargestYaml),
                   .got = std::to_string(text.size()),
                   .where = source_});
    }
    try {
      document_ = YAML::Load(std::string(text));
    } catch (const YAML::Exception& complaint) {
      throw Error({.what = fmt::format("YAML that cannot be read ({})", escaped(complaint.msg)),
                   .where = fmt::format("{}:{}", source_, complaint.mark.line + 1)});
    }
    if (!document_.IsMap()) throw Error({.what = "not a map of ROS", .expected = "keys and values", .where = source_});
  }

  GridMap read() {
    GridFrame frame{.unit = "m"};
    frame.cell_size = number("resolution", std::nullopt, 1e-6, 1e6);
    read_origin(frame);
    const bool negate = flag("negate");
    const double occupied = number("occupied_thresh", kOccupiedThreshold, 0, 1);
    const double free = number("free_thresh", kFreeThreshold, 0, 1);
    if (free > occupied) fail("free_thresh", "free_thresh is above occupied_thresh", "at most occupied_thresh");
    const Mode mode = read_mode();
    const std::filesystem::path path = picture_path();
    const double cell_pixels = std::max(1.0, options_.cell_size.value_or(0) / frame.cell_size);
    const Raster picture = read_picture(read_file(path), path.string(), cell_pixels);

    GridMap map{.rows = picture.height, .cols = picture.width, .blocked = {}, .frame = frame};
    map.blocked.reserve(picture.samples.size() / picture.channels);
    for (std::size_t at = 0; at < picture.samples.size(); at += picture.channels) {
      const Pixel pixel = pixel_of({&picture.samples[at], static_cast<std::size_t>(picture.channels)}, mode);
      const double shade = pixel.level / 255.0;
      const double occupancy = mode == Mode::kRaw ? std::round(pixel.level) / kMostRawOccupancy
                               : negate           ? shade
                                                  : 1 - shade;
      const bool unknown = (occupancy >= free && occupancy <= occupied) || (mode == Mode::kRaw && occupancy > 1) ||
                           (mode == Mode::kScale && pixel.transparent);
      map.blocked.push_back(unknown ? !options_.unknown_is_free : occupancy > occupied);
    }
    if (std::find(map.blocked.begin(), map.blocked.end(), false) == map.blocked.end()) {
      throw Error({.what = "the map has no free cell", .where = source_});
    }
    return map;
  }

 private:
  [[noreturn]] void fail(const std::string& key, const std::string& what, const std::string& expected) const {
    const YAML::Node node = document_[key];
    const bool scalar = node.IsDefined() && node.IsScalar();
    throw Error({.what = what,
                 .expected = expected,
                 .got = scalar ? in_quotes(node.Scalar()) : "",
                 .where = node.IsDefined() ? fmt::format("{}:{}", source_, node.Mark().line + 1) : source_});
  }

  double number(const std::string& key, std::optional<double> fallback, double least, double most) const {
    const YAML::Node node = document_[key];
    const std::string expected = fmt::format("a number from {:g} to {:g}", least, most);
    if (!node.IsDefined() && fallback) return *fallback;
    if (!node.IsDefined()) fail(key, fmt::format("no key \"{}\"", key), expected);
    const auto value = node.IsScalar() ? parse_number(node.Scalar()) : std::nullopt;
    if (!value || *value < least || *value > most) fail(key, fmt::format("bad {}", key), expected);
    return *value;
  }

  bool flag(const std::string& key) const {
    const YAML::Node node = document_[key];
    if (!node.IsDefined()) return false;
    bool yes = false;  // of YAML's words: true, yes, on
    const auto value = node.IsScalar() ? parse_number(node.Scalar()) : std::nullopt;
    if (value ? *value != 0 && *value != 1 : !YAML::convert<bool>::decode(node, yes)) {
      fail(key, fmt::format("bad {}", key), "0 or 1");
    }
    return value ? *value == 1 : yes;
  }

  void read_origin(GridFrame& frame) const {
    const YAML::Node node = document_["origin"];
    if (!node.IsDefined()) return;
    std::vector<double> values;
    for (std::size_t i = 0; node.IsSequence() && i < node.size(); ++i) {
      const auto value = node[i].IsScalar() ? parse_number(node[i].Scalar()) : std::nullopt;
      if (value) values.push_back(*value);
    }
    if (!node.IsSequence() || values.size() != node.size() || values.size() < 2 || values.size() > 3) {
      fail("origin", "bad origin", "[x, y, yaw]");
    }
    frame.origin = {values[0], values[1]};
    if (values.size() == 3) frame.yaw = values[2];
  }

  Mode read_mode() const {
    const YAML::Node node = document_["mode"];
    if (!node.IsDefined()) return Mode::kTrinary;
    const std::string value = node.IsScalar() ? node.Scalar() : "";
    if (same_name(value, "trinary")) return Mode::kTrinary;
    if (same_name(value, "scale")) return Mode::kScale;
    if (same_name(value, "raw")) return Mode::kRaw;
    fail("mode", "bad mode", "trinary, scale or raw");
  }

  // The picture lies in the folder of the YAML file, or below it. An absolute path may be that of another machine: then
  // the file of this name beside the YAML file.
  std::filesystem::path picture_path() const {
    const YAML::Node node = document_["image"];
    if (!node.IsDefined() || !node.IsScalar() || node.Scalar().empty()) fail("image", "no picture", "image: FILE");
    const std::filesystem::path folder = std::filesystem::path(source_).parent_path();
    const std::string& image = node.Scalar();
    const std::string name = image.substr(image.find_last_of("/\\") + 1);
    const bool windows = image.size() > 2 && image[1] == ':' && (image[2] == '\\' || image[2] == '/');
    if (!windows && lies_in(folder, image)) return folder / image;
    std::error_code error;
    if ((windows || image.starts_with('/')) && !name.empty() && std::filesystem::exists(folder / name, error) &&
        lies_in(folder, name)) {
      if (options_.note) options_.note(fmt::format("{}: {} beside it is read, not {}", source_, name, image));
      return folder / name;
    }
    fail("image", "the picture lies outside of the folder", "a file beside this one: copy it, and name it alone");
  }

  static bool lies_in(const std::filesystem::path& folder, const std::filesystem::path& image) {
    std::error_code error;
    const std::filesystem::path real_folder = std::filesystem::weakly_canonical(folder.empty() ? "." : folder, error);
    const std::filesystem::path real = std::filesystem::weakly_canonical(folder / image, error);
    const auto [end, rest] = std::mismatch(real_folder.begin(), real_folder.end(), real.begin(), real.end());
    return !error && end == real_folder.end();
  }

  const std::string& source_;
  const MapOptions& options_;
  YAML::Node document_;
};

}  // namespace

bool is_ros_map(std::string_view text) {
  text = text.substr(0, kLargestYaml);
  for (const char* const key : {"image", "resolution"}) {
    if (text.find(key) == std::string_view::npos) return false;
  }
  try {
    const YAML::Node document = YAML::Load(std::string(text));
    return document.IsMap() && document["image"].IsDefined() && document["resolution"].IsDefined();
  } catch (const YAML::Exception&) {
    // A damaged one: its reader says where.
    bool image = false;
    bool resolution = false;
    for (Lines lines(text); lines.next();) {
      image = image || lines.line().starts_with("image:");
      resolution = resolution || lines.line().starts_with("resolution:");
    }
    return image && resolution;
  }
}

GridMap parse_ros_map(std::string_view text, const std::string& source, const MapOptions& options) {
  return RosMapReader(text, source, options).read();
}

}  // namespace graphdrl
