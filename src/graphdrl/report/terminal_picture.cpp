#include "graphdrl/report/terminal_picture.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

#include "graphdrl/report/picture.h"

namespace graphdrl {
namespace {

constexpr int kFewestLines = 8;  // of a map, however small the screen
constexpr Colour kMissedCell = {255, 175, 135};
constexpr Colour kUnseenCell = {175, 175, 175};
constexpr Colour kBlack = {0, 0, 0};  // blocked cells too: no colour of the walk is near it
constexpr Colour kWhite = {255, 255, 255};
constexpr double kDarkUpTo = 0.45;  // colour_of_share(): white letters stand out below, black ones above

// The nearest colour of the 6×6×6 cube of terminals with 256 colours.
int cube_index(Colour colour) {
  const auto level = [](int value) { return value < 48 ? 0 : value < 115 ? 1 : (value - 35) / 40; };
  return 16 + 36 * level(colour.red) + 6 * level(colour.green) + level(colour.blue);
}

// Characters of a text in UTF-8.
int width_of(std::string_view text) {
  return static_cast<int>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

// One line of a picture. Escape codes stand only between characters of different colours.
class Line {
 public:
  explicit Line(bool colour) : colour_(colour) {}

  void add(std::string_view text, Colour ink, Colour ground) {
    const std::array<int, 2> style = {cube_index(ink), cube_index(ground)};
    if (colour_ && style != style_) text_ += fmt::format("\033[38;5;{};48;5;{}m", style[0], style[1]);
    style_ = style;
    text_ += text;
  }

  std::string finished() {
    if (colour_) return text_ + "\033[0m\n";
    text_.resize(text_.find_last_not_of(' ') + 1);
    return text_ + '\n';
  }

 private:
  bool colour_;
  std::array<int, 2> style_ = {-1, -1};
  std::string text_;
};

class Drawing {
 public:
  Drawing(const World& world, std::span<const NodeId> walk, const Screen& screen, const Fog& fog)
      : world_(world),
        map_(*world.map()),
        walk_(walk),
        screen_(screen),
        fog_(fog),
        visited_at_(first_visits(world, walk)) {}

  std::string draw() const {
    const std::string legend = legend_of({"arrows: the first way out of a cell"}, ". not visited");
    if (map_.cols <= screen_.columns && map_.rows <= lines_beside(legend)) return draw_cells() + legend;
    const auto divided = [](int a, int b) { return (a + b - 1) / b; };
    for (int k = divided(map_.cols, screen_.columns);; ++k) {
      const std::string block_legend = legend_of_blocks(k);
      if (divided(map_.rows, 2 * k) <= lines_beside(block_legend)) return draw_blocks(k) + block_legend;
    }
  }

 private:
  std::string draw_cells() const {
    // Two columns a cell look square.
    const std::string_view gap = 2 * map_.cols <= screen_.columns ? " " : "";
    const std::vector<std::string_view> arrows = leaving();
    std::string text;
    for (int row = 0; row < map_.rows; ++row) {
      Line line(screen_.colour);
      for (int col = 0; col < map_.cols; ++col) {
        const NodeId node = map_.node({row, col});
        const std::string_view mark = mark_of(row, row + 1, col, col + 1);
        const std::string_view glyph = !mark.empty()             ? mark
                                       : is_unseen(node)         ? " "
                                       : world_.is_blocked(node) ? (screen_.colour ? " " : "#")
                                                                 : arrows[node];
        line.add(std::string(glyph) += gap, share_of(node) <= kDarkUpTo && visited_at_[node] >= 0 ? kWhite : kBlack,
                 colour_of(node));
      }
      text += line.finished();
    }
    return text;
  }

  // k: cells a side of a pixel.
  std::string draw_blocks(int k) const {
    std::string text;
    for (int row = 0; row < map_.rows; row += 2 * k) {
      Line line(screen_.colour);
      for (int col = 0; col < map_.cols; col += k) {
        const Pixel top = pixel(row, col, k);
        const Pixel bottom = pixel(row + k, col, k);
        if (const std::string_view mark = mark_of(row, row + 2 * k, col, col + k); !mark.empty()) {
          line.add(mark, kBlack, kWhite);
        } else if (screen_.colour) {
          line.add("▀", top.colour, bottom.colour);
        } else {
          const bool seen = top.seen + bottom.seen > 0;
          line.add(seen ? shade(top.free + bottom.free, top.visited + bottom.visited) : " ", kBlack, kBlack);
        }
      }
      text += line.finished();
    }
    return text;
  }

  struct Pixel {
    Colour colour;  // the mean of its cells
    int seen = 0;
    int free = 0;  // and seen
    int visited = 0;
  };

  // The cells from (row, col) on, as far as the map goes.
  Pixel pixel(int row, int col, int k) const {
    std::array<int, 3> sum = {};
    int count = 0;
    Pixel result{.colour = kBlack};
    for (int r = row; r < std::min(row + k, map_.rows); ++r) {
      for (int c = col; c < std::min(col + k, map_.cols); ++c, ++count) {
        const NodeId node = map_.node({r, c});
        const Colour colour = colour_of(node);
        sum[0] += colour.red;
        sum[1] += colour.green;
        sum[2] += colour.blue;
        result.seen += is_unseen(node) ? 0 : 1;
        result.free += is_unseen(node) || world_.is_blocked(node) ? 0 : 1;
        result.visited += visited_at_[node] >= 0 ? 1 : 0;
      }
    }
    if (count == 0) return result;
    const auto mean = [&](int channel) { return static_cast<std::uint8_t>(sum[channel] / count); };
    result.colour = {mean(0), mean(1), mean(2)};
    return result;
  }

  static std::string_view shade(int free, int visited) {
    constexpr std::array<std::string_view, 5> kShades = {".", "░", "▒", "▓", "█"};
    return free == 0 ? "#" : kShades[(4 * visited + free - 1) / free];
  }

  // When in the walk a node is first visited, from 0 to 1.
  double share_of(NodeId node) const {
    return walk_.size() < 2 ? 0 : visited_at_[node] / static_cast<double>(walk_.size() - 1);
  }

  bool is_unseen(NodeId node) const { return fog_.lifts_at(node) < 0; }

  Colour colour_of(NodeId node) const {
    if (is_unseen(node)) return kUnseenCell;
    if (world_.is_blocked(node)) return kBlack;
    return visited_at_[node] < 0 ? kMissedCell : colour_of_share(share_of(node));
  }

  // The letter of the walk's start or end, where one of the cells is it.
  std::string_view mark_of(int row, int last_row, int col, int last_col) const {
    const auto holds = [&](NodeId node) {
      const Cell cell = map_.cell(node);
      return cell.row >= row && cell.row < last_row && cell.col >= col && cell.col < last_col;
    };
    return holds(walk_.front()) ? "S" : holds(walk_.back()) ? "E" : "";
  }

  // For each node the arrow to the cell that follows its first visit; "." where the walk never is. [N]
  std::vector<std::string_view> leaving() const {
    constexpr std::array<std::string_view, 9> kArrows = {"↖", "↑", "↗", "←", ".", "→", "↙", "↓", "↘"};
    const auto sign = [](int a) { return a < 0 ? -1 : a > 0 ? 1 : 0; };
    std::vector<std::string_view> arrows(visited_at_.size(), ".");
    for (std::size_t i = 1; i < walk_.size(); ++i) {
      // A blocked move repeats a node; the arrow is that of the next one.
      if (arrows[walk_[i - 1]] != "." || walk_[i] == walk_[i - 1]) continue;
      const Cell from = map_.cell(walk_[i - 1]);
      const Cell to = map_.cell(walk_[i]);
      arrows[walk_[i - 1]] = kArrows[4 + 3 * sign(to.row - from.row) + sign(to.col - from.col)];
    }
    return arrows;
  }

  // The lines of the screen that are left for the map.
  int lines_beside(const std::string& legend) const {
    return std::max(screen_.lines - static_cast<int>(std::count(legend.begin(), legend.end(), '\n')), kFewestLines);
  }

  std::string legend_of_blocks(int k) const {
    std::vector<std::string> parts = {fmt::format("a character: {} × {} cells", k, 2 * k)};
    if (!screen_.colour) parts.emplace_back("░▒▓█ share visited");
    return legend_of(parts, ". none visited");
  }

  // As many parts on a line as fit.
  std::string legend_of(std::vector<std::string> parts, const std::string& missed) const {
    parts.insert(parts.begin(), walk_.front() == walk_.back() ? "S start and end" : "S start, E end");
    if (screen_.colour) {
      for (const char* const part : {"violet to yellow: early to late", "orange: not visited", "black: blocked"}) {
        parts.emplace_back(part);
      }
      if (!fog_.empty()) parts.emplace_back("grey: not seen");
    } else {
      parts.push_back(missed + ", # blocked" + (fog_.empty() ? "" : ", blank: not seen"));
    }
    std::string text;
    std::string line;
    for (const std::string& part : parts) {
      if (!line.empty() && width_of(line) + 2 + width_of(part) > screen_.columns) {
        text += std::exchange(line, "") + '\n';
      }
      line += (line.empty() ? "" : "; ") + part;
    }
    return text + line + '\n';
  }

  const World& world_;
  const GridMap& map_;
  std::span<const NodeId> walk_;
  Screen screen_;
  const Fog& fog_;
  std::vector<int> visited_at_;  // [N]
};

bool is_set(const char* name) {
  const char* const value = std::getenv(name);
  return value != nullptr && *value != '\0';
}

}  // namespace

Screen screen_of(std::FILE* out) {
  Screen screen;
  if (const char* const columns = std::getenv("COLUMNS"); columns != nullptr) {
    int value = 0;
    std::from_chars(columns, columns + std::strlen(columns), value);
    if (value > 0) screen.columns = value;
  }
  if (isatty(fileno(out)) == 0) return screen;
  winsize size{};
  if (ioctl(fileno(out), TIOCGWINSZ, &size) == 0 && size.ws_col > 0) {
    screen.columns = size.ws_col;
    if (size.ws_row > 0) screen.lines = size.ws_row;
  }
  const char* const terminal = std::getenv("TERM");
  screen.colour = !is_set("NO_COLOR") && !(terminal != nullptr && std::string_view(terminal) == "dumb");
  return screen;
}

std::string draw_walk(const World& world, std::span<const NodeId> walk, const Screen& screen, const Fog& fog) {
  return Drawing(world, walk, screen, fog).draw();
}

}  // namespace graphdrl
