#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <optional>

#include "graphdrl/io/readers.h"
#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

constexpr double kMostPlaces = 100'000;
constexpr double kMostInTeam = 1e9;
constexpr double kMostInTeamFile = 1e15;

class Distances final : public PairCosts {
 public:
  explicit Distances(std::vector<Point> points) : points_(std::move(points)) {}
  double cost(NodeId from, NodeId to) const override { return length_between(points_[from], points_[to]); }
  bool metric() const override { return true; }

 private:
  std::vector<Point> points_;
};

// The words of a line: signs between them do not count.
std::vector<std::string> words_of(std::string_view line) {
  std::string plain(line);
  for (char& c : plain) {
    if (c == ';' || c == ',' || c == ':' || c == '=') c = ' ';
  }
  return split_fields(plain, ' ');
}

class ChaoReader {
 public:
  ChaoReader(std::string_view text, const std::string& source, const MapOptions& options)
      : lines_(text, source), options_(options) {}

  GraphMap read() {
    while (std::ssize(points_) < places_ || places_ == 0 || team_ == 0 || !limit_) {
      if (!next_line()) {
        lines_.fail("the file ends too early",
                    places_ == 0 ? "n, m, tmax and places" : fmt::format("{} places", places_));
      }
      if (words_.size() == 2) {
        read_key();
      } else {
        read_place();
      }
    }
    if (next_line()) lines_.fail("more places than n", fmt::format("{}", places_));
    const auto count = static_cast<NodeId>(places_);
    return {.graph = Graph::complete(count, std::make_shared<Distances>(points_), options_.progress),
            .blocked = std::vector<bool>(count),
            .prizes = std::move(prizes_),
            .places = {.points = points_, .unit = {}},
            .task = {.budget = limit_, .start = 0, .end = count - 1}};
  }

 private:
  bool next_line() {
    while (lines_.next()) {
      if (is_comment(lines_.line())) continue;
      words_ = words_of(lines_.line());
      return true;
    }
    return false;
  }

  double number(std::size_t word, double least, double most, const std::string& what) const {
    const auto value = parse_number(words_[word]);
    if (!value || *value < least || *value > most) {
      lines_.fail("bad " + what, fmt::format("a number from {:g} to {:g}", least, most));
    }
    return *value;
  }
  int whole(double most, const std::string& what) const {
    const double value = number(1, 1, most, what);
    if (value != std::floor(value)) lines_.fail("bad " + what, "a whole number");
    return static_cast<int>(value);
  }

  void read_key() {
    if (same_name(words_[0], "n") && places_ == 0) {
      places_ = whole(kMostPlaces, "number of places");
    } else if (same_name(words_[0], "m") && team_ == 0) {
      team_ = whole(kMostInTeam, "size of the team");
      if (team_ > 1) {
        lines_.fail(fmt::format("teams cannot be planned yet, and this is a problem for a team of {}", team_), "m 1");
      }
    } else if (same_name(words_[0], "tmax") && !limit_) {
      limit_ = number(1, 0, kMostInTeamFile, "limit");
    } else {
      lines_.fail("strange line", "n, m and tmax, once each, then x, y and score of each place");
    }
  }

  void read_place() {
    if (words_.size() != 3) lines_.fail("not a place", "x, y and score");
    if (places_ > 0 && std::ssize(points_) == places_) lines_.fail("more places than n", std::to_string(places_));
    points_.push_back(
        {number(0, -kMostInTeamFile, kMostInTeamFile, "x"), number(1, -kMostInTeamFile, kMostInTeamFile, "y")});
    prizes_.push_back(number(2, 0, kMostInTeamFile, "score"));
  }

  Lines lines_;
  const MapOptions& options_;
  std::vector<std::string> words_;  // of the line
  int places_ = 0;
  int team_ = 0;
  std::optional<double> limit_;
  std::vector<Point> points_;
  std::vector<double> prizes_;
};

}  // namespace

bool is_chao(std::string_view text) {
  bool places = false;
  for (Lines lines(text); lines.next();) {
    if (is_comment(lines.line())) continue;
    const std::vector<std::string> words = words_of(lines.line());
    if (words.size() != 2 || !parse_number(words[1])) return false;
    if (places) return same_name(words[0], "m") || same_name(words[0], "tmax");
    places = same_name(words[0], "n");
    if (!places) return false;
  }
  return false;
}

GraphMap parse_chao(std::string_view text, const std::string& source, const MapOptions& options) {
  return ChaoReader(text, source, options).read();
}

}  // namespace graphdrl
