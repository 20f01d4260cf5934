#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "graphdrl/base/random.h"
#include "graphdrl/graph/grid_generators.h"
#include "graphdrl/live/live_exploration.h"
#include "support.h"

namespace graphdrl {
namespace {

using ::testing::HasSubstr;

constexpr double kSide = 0.5;  // of a cell

// A robot in a building that it sees bit by bit. It looks along lines of a length, and feels what is beside it.
class Robot {
 public:
  Robot(GridMap building, Cell at, double sight) : building_(std::move(building)), at_(at), sight_(sight) {}

  Cell at() const { return at_; }
  Point point() const { return centre(at_); }
  void stand(Cell at) { at_ = at; }
  void block(const Cell& cell, bool blocked) { building_.blocked[building_.node(cell)] = blocked; }
  bool is_free(const Cell& cell) const { return building_.is_free(cell); }
  static Point centre(const Cell& cell) { return {(cell.col + 0.5) * kSide, (-cell.row + 0.5) * kSide}; }
  static Cell cell_at(const Point& point) {
    return {-static_cast<int>(std::floor(point.y / kSide)), static_cast<int>(std::floor(point.x / kSide))};
  }

  // What it sees from where it stands: a patch around it, of which most is not known.
  CellPatch look() const {
    const int range = static_cast<int>(sight_ / kSide) + 1;
    const int side = 2 * range + 1;
    CellPatch patch{.origin = {(at_.col - range) * kSide, (-at_.row - range) * kSide},
                    .resolution = kSide,
                    .width = side,
                    .height = side,
                    .data = std::vector<std::int8_t>(static_cast<std::size_t>(side) * side, -1)};
    const auto see = [&](const Cell& cell) {
      const int up = -cell.row + at_.row + range;
      patch.data[static_cast<std::size_t>(up) * side + (cell.col - at_.col + range)] = is_free(cell) ? 0 : 100;
      return is_free(cell);
    };
    see(at_);
    for (const Cell& step : kGridSteps) see(at_ + step);
    for (int ray = 0; ray < 360; ++ray) {
      const double angle = std::numbers::pi / 180 * ray;
      for (double far = 0; far <= sight_ / kSide; far += 0.5) {
        const Cell cell = {at_.row + static_cast<int>(std::lround(far * std::sin(angle))),
                           at_.col + static_cast<int>(std::lround(far * std::cos(angle)))};
        if (!see(cell)) break;
      }
    }
    return patch;
  }

 private:
  GridMap building_;
  Cell at_;
  double sight_;
};

// Walls around rooms at random.
GridMap building(Rng& rng, int rows, int cols, double blocked) {
  GridMap map{.rows = rows, .cols = cols, .blocked = {}};
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      const bool wall = row == 0 || col == 0 || row == rows - 1 || col == cols - 1;
      map.blocked.push_back(wall || rng.uniform() < blocked);
    }
  }
  return map;
}

Cell free_cell(Rng& rng, const GridMap& map) {
  while (true) {
    const Cell cell = {rng.index(map.rows), rng.index(map.cols)};
    if (map.is_free(cell)) return cell;
  }
}

// Cells that can be reached, without cutting corners.
std::set<std::pair<int, int>> in_reach(const GridMap& map, const Cell& from, int connectivity) {
  std::set<std::pair<int, int>> seen = {{from.row, from.col}};
  std::vector<Cell> open = {from};
  while (!open.empty()) {
    const Cell at = open.back();
    open.pop_back();
    for (int i = 0; i < connectivity; ++i) {
      const Cell& step = kGridSteps[i];
      const Cell to = at + step;
      if (!map.is_free(to) || !map.is_free(at + Cell{step.row, 0}) || !map.is_free(at + Cell{0, step.col})) continue;
      if (seen.emplace(to.row, to.col).second) open.push_back(to);
    }
  }
  return seen;
}

struct Ending {
  LiveStep end;
  double walked = 0;
  std::set<std::pair<int, int>> entered;
};

// Goes where it is sent, up to `stride` cells between reports, and checks each way.
Ending explore(LiveExploration& exploration, Robot robot, int stride, int connectivity) {
  Ending ending;
  ending.entered.emplace(robot.at().row, robot.at().col);
  for (int report = 0; report < 100'000; ++report) {
    exploration.observe({.at = robot.point(), .cells = robot.look()});
    ending.end = exploration.next();
    if (ending.end.kind == LiveStep::Kind::kDone) return ending;
    if (ending.end.kind != LiveStep::Kind::kGoto || ending.end.way.empty()) {
      ADD_FAILURE() << "no way";
      return ending;
    }
    int steps = 0;
    for (const Point& point : ending.end.way) {
      const Cell to = Robot::cell_at(point);
      const Cell step = {to.row - robot.at().row, to.col - robot.at().col};
      EXPECT_LE(std::max(std::abs(step.row), std::abs(step.col)), 1);
      EXPECT_TRUE(connectivity == 8 || std::abs(step.row) + std::abs(step.col) == 1);
      EXPECT_TRUE(robot.is_free(to) && robot.is_free(robot.at() + Cell{step.row, 0}) &&
                  robot.is_free(robot.at() + Cell{0, step.col}));
      ending.walked += kSide * std::hypot(step.row, step.col);
      robot.stand(to);
      ending.entered.emplace(to.row, to.col);
      if (++steps == stride) break;
    }
  }
  ADD_FAILURE() << "it never ends";
  return ending;
}

TEST(LiveCells, AreAllSeenByEveryPolicy) {
  Rng rng(1);
  for (const std::string policy : {"", "nearest", "frontier", "tour:4", "dfs", "explorer", "search:1000", "beam:4"}) {
    for (const int connectivity : {4, 8}) {
      const GridMap map = building(rng, 18, 24, 0.2);
      const Cell start = free_cell(rng, map);
      LiveExploration exploration({.connectivity = connectivity, .policy = policy});
      const Ending ending = explore(exploration, Robot(map, start, 3), 1 + rng.index(12), connectivity);
      // What is left can be seen, but not reached.
      const LiveReport report = exploration.report();
      ASSERT_TRUE(report.cells.has_value());
      EXPECT_EQ(ending.end.done, report.cells->left > 0 ? LiveStep::Done::kUnreachable : LiveStep::Done::kCovered);
      const GridMap seen = std::get<GridMap>(exploration.map());
      const Point corner = seen.frame->origin;
      for (const auto& [row, col] : in_reach(map, start, connectivity)) {
        const Point centre = Robot::centre({row, col});
        const Cell cell = {seen.rows - 1 - static_cast<int>((centre.y - corner.y) / kSide),
                           static_cast<int>((centre.x - corner.x) / kSide)};
        EXPECT_TRUE(seen.is_free(cell)) << policy;
      }
      EXPECT_NEAR(report.cost, ending.walked, 1e-6) << policy;
    }
  }
}

TEST(LiveCells, AreAllVisitedWhereVisitsCount) {
  Rng rng(2);
  for (const std::string policy : {"", "nearest", "tour", "beam:4"}) {
    const GridMap map = building(rng, 12, 15, 0.2);
    const Cell start = free_cell(rng, map);
    LiveExploration exploration({.score = Score::kVisited, .connectivity = 4, .policy = policy});
    const Ending ending = explore(exploration, Robot(map, start, 2), 1000, 4);
    EXPECT_EQ(ending.entered, in_reach(map, start, 4)) << policy;
    EXPECT_EQ(exploration.report().cells->visited, std::ssize(ending.entered));
  }
}

TEST(LiveCells, ComeHomeWithinTheBudget) {
  Rng rng(3);
  int not_all = 0;
  for (int round = 0; round < 30; ++round) {
    const GridMap map = building(rng, 20, 20, 0.15);
    const Cell start = free_cell(rng, map);
    const double budget = rng.index(30);
    LiveExploration exploration({.budget = budget, .end_at_start = true});
    const Ending ending = explore(exploration, Robot(map, start, 2), 1 + rng.index(5), 8);
    EXPECT_LE(ending.walked, budget + 1e-6);
    EXPECT_EQ(Robot::cell_at(exploration.report().cells->at), start);
    not_all += ending.end.done == LiveStep::Done::kBudget;
  }
  EXPECT_GT(not_all, 5);
}

// A corridor of eleven cells, from left to right.
Robot in_corridor(double sight = 1) {
  GridMap map{.rows = 3, .cols = 13, .blocked = std::vector<bool>(39, true)};
  for (int col = 1; col < 12; ++col) map.blocked[map.node({1, col})] = false;
  return {map, {1, 1}, sight};
}

TEST(LiveCells, GoOnWithWhatTheyAreToldOnTheWay) {
  Robot robot = in_corridor(3);
  LiveExploration exploration({});
  exploration.observe({.at = robot.point(), .cells = robot.look()});
  const LiveStep step = exploration.next();
  ASSERT_GT(step.way.size(), 3u);
  // From the middle of the way, with nothing new: the rest of it.
  exploration.observe({.at = step.way[1]});
  EXPECT_EQ(exploration.next().way, std::vector<Point>(step.way.begin() + 2, step.way.end()));
  // A wall where the way led.
  const Cell wall = Robot::cell_at(step.way[3]);
  robot.stand(Robot::cell_at(step.way[1]));
  robot.block(wall, true);
  exploration.observe({.at = robot.point(), .cells = robot.look()});
  EXPECT_EQ(exploration.next().kind, LiveStep::Kind::kDone);
  EXPECT_EQ(exploration.report().cells->changed, 1);
  // And away again.
  robot.block(wall, false);
  exploration.observe({.at = robot.point(), .cells = robot.look()});
  EXPECT_GT(exploration.next().way.back().x, step.way[3].x);
}

TEST(LiveCells, GiveUpGoalsThatFailThreeTimes) {
  const Robot robot = in_corridor();
  LiveExploration exploration({});
  exploration.observe({.at = robot.point(), .cells = robot.look()});
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(exploration.next().kind, LiveStep::Kind::kGoto) << i;
    exploration.observe({.failed = true, .at = robot.point()});
  }
  EXPECT_EQ(exploration.next().done, LiveStep::Done::kUnreachable);
  const LiveReport report = exploration.report();
  ASSERT_EQ(report.cells->failed.size(), 1u);
  EXPECT_EQ(report.cells->failed[0].failures, 3);
  EXPECT_EQ(report.cells->left, 1);
  EXPECT_EQ(report.steps, 3);
}

TEST(LiveCells, GoHomeThoughAGoalNearItWasGivenUp) {
  GridMap map{.rows = 3, .cols = 30, .blocked = std::vector<bool>(90, true)};
  for (int col = 1; col < 29; ++col) map.blocked[map.node({1, col})] = false;
  const Cell start = {1, 12};
  Robot robot(map, start, 2);
  LiveExploration exploration({.end_at_start = true, .policy = "nearest"});
  int failures = 0;
  LiveStep step;
  for (int report = 0; report < 100; ++report) {
    LiveObservation seen{.at = robot.point(), .cells = robot.look()};
    if (step.kind == LiveStep::Kind::kGoto) {
      const Cell goal = Robot::cell_at(step.way.back());
      seen.failed = goal.col < start.col;  // there it never gets
      failures += seen.failed;
      if (!seen.failed) robot.stand(goal);
      seen.at = robot.point();
      seen.cells = robot.look();
    }
    exploration.observe(seen);
    step = exploration.next();
    if (step.kind == LiveStep::Kind::kDone) break;
  }
  EXPECT_EQ(failures, 3);
  EXPECT_EQ(robot.at(), start);
  EXPECT_EQ(step.done, LiveStep::Done::kUnreachable);
}

TEST(LiveCells, DoNotGoHomeForEverWhereTheWayFails) {
  Robot robot = in_corridor(20);
  LiveExploration exploration({.end_at_start = true, .policy = "nearest"});
  exploration.observe({.at = robot.point(), .cells = robot.look()});
  robot.stand({1, 9});
  exploration.observe({.at = robot.point(), .cells = robot.look()});
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(exploration.next().kind, LiveStep::Kind::kGoto) << i;
    exploration.observe({.failed = true, .at = robot.point()});
  }
  EXPECT_EQ(exploration.next().kind, LiveStep::Kind::kDone);
}

TEST(LiveCells, StandInTheNearestFreeCellWhereTheirOwnIsBlocked) {
  LiveExploration exploration({});
  exploration.observe(
      {.at = {{0.2, 0.2}}, .cells = CellPatch{.resolution = 1, .width = 3, .height = 1, .data = {100, 0, 0}}});
  EXPECT_EQ(exploration.next().way.front(), (Point{2.5, 0.5})) << "from the cell in the middle";
}

TEST(LiveCells, RefuseWhatCannotBe) {
  const CellPatch patch{.resolution = 0.5, .width = 2, .height = 1, .data = {0, 0}};
  const Point at = {0.1, 0.1};
  const auto error = [&](const LiveObservation& seen, bool begun = true) {
    LiveExploration exploration({});
    if (begun) exploration.observe({.at = at, .cells = patch});
    const LiveReport before = exploration.report();
    const std::string text = error_of([&] { exploration.observe(seen); });
    EXPECT_EQ(exploration.observed(), begun);
    if (begun) {
      EXPECT_EQ(exploration.report().cells->seen, before.cells->seen);
    }
    return text;
  };
  CellPatch other = patch;
  other.resolution = 0.4;
  EXPECT_THAT(error({.at = at, .cells = other}), HasSubstr("the resolution was 0.5"));
  other = patch;
  other.origin.x = 0.2;
  EXPECT_THAT(error({.at = at, .cells = other}), HasSubstr("between the cells"));
  other.origin.x = 1e18;
  EXPECT_THAT(error({.at = at, .cells = other}), HasSubstr("too far"));
  other.origin = {30000, 30000};
  EXPECT_THAT(error({.at = at, .cells = other}), HasSubstr("a rectangle around all cells"));
  other = patch;
  other.width = 3;
  EXPECT_THAT(error({.at = at, .cells = other}), HasSubstr("2 values for 3 × 1"));
  other.resolution = std::numeric_limits<double>::infinity();
  EXPECT_THAT(error({.at = at, .cells = other}), HasSubstr("resolution"));
  other = patch;
  other.data = {100, 100};
  EXPECT_THAT(error({.at = at, .cells = other}, false), HasSubstr("no free cell is near"));
  EXPECT_THAT(error({.at = {{1e300, 0}}}), HasSubstr("no free cell is near"));
  EXPECT_THAT(error({.at = {{std::nan(""), 0}}}), HasSubstr("not finite"));
  EXPECT_THAT(error({.at = at}, false), HasSubstr("the cells around"));
  EXPECT_THAT(error({.state = "a"}), HasSubstr("one of cells"));
  EXPECT_THAT(error({.failed = true, .at = at}, false), HasSubstr("nothing was asked for"));
  EXPECT_THAT(error({.cost = -1, .at = at}), HasSubstr("cost"));
  EXPECT_THAT(error_of([&] {
                LiveExploration exploration({.cover = Cover::kEdges});
                exploration.observe({.at = at, .cells = patch});
              }),
              HasSubstr("cover"));
  EXPECT_THAT(error_of([&] {
                LiveExploration exploration({.policy = "novelty"});
                exploration.observe({.at = at, .cells = patch});
              }),
              HasSubstr("for states"));
  LiveExploration states({});
  states.observe({.state = "a"});
  EXPECT_THAT(error_of([&] { states.observe({.at = at, .cells = patch}); }), HasSubstr("one of states"));
}

// A robot whose sensors, legs and messages are not to be trusted: whatever it says, ways lead through free cells, costs
// add up, and pictures have all steps of the walk.
TEST(LiveCells, BearALyingRobot) {
  Rng rng(4);
  for (int round = 0; round < 60; ++round) {
    const bool home = rng.index(2) == 0;
    LiveOptions options{.connectivity = rng.index(2) == 0 ? 4 : 8, .end_at_start = home};
    if (rng.index(2) == 0) options.score = Score::kVisited;
    if (rng.index(2) == 0) options.budget = rng.index(60);
    if (rng.index(2) == 0) options.policy = "nearest";
    LiveExploration exploration(options);
    std::map<std::pair<int, int>, int> said;  // by column and row upward
    Point at = {0, 0};
    LiveStep step;
    for (int report = 0; report < 60; ++report) {
      LiveObservation seen{.at = at};
      if (report == 0 || rng.index(3) > 0) {
        CellPatch patch{.origin = {1.0 * rng.index(8), 1.0 * rng.index(8)},
                        .resolution = 1,
                        .width = 1 + rng.index(8),
                        .height = 1 + rng.index(8)};
        if (report == 0) patch.origin = {0, 0};
        for (int i = 0; i < patch.width * patch.height; ++i) {
          const int value = std::vector{-1, 0, 0, 0, 20, 50, 70, 100}[rng.index(8)];
          patch.data.push_back(static_cast<std::int8_t>(value));
          if (value >= 0 && (value <= 25 || value >= 65)) {
            said[{static_cast<int>(patch.origin.x) + i % patch.width,
                  static_cast<int>(patch.origin.y) + i / patch.width}] = value;
          }
        }
        seen.cells = patch;
      }
      if (rng.index(5) == 0) seen.cost = rng.index(4);
      if (report > 0 && step.kind == LiveStep::Kind::kGoto) seen.failed = rng.index(6) == 0;
      try {
        exploration.observe(seen);
      } catch (const Error&) {
        if (!exploration.observed()) break;
        at = {0.5, 0.5};
        continue;
      }
      step = exploration.next();
      for (const Point& point : step.way) {
        const auto known = said.find({static_cast<int>(std::floor(point.x)), static_cast<int>(std::floor(point.y))});
        EXPECT_TRUE(known == said.end() || known->second <= 25) << "a way through what is blocked";
      }
      at = step.way.empty() || rng.index(4) == 0 ? Point{rng.uniform() * 15, rng.uniform() * 15}
                                                 : step.way[rng.index(static_cast<int>(step.way.size()))];
    }
    if (!exploration.observed()) continue;
    const Answer answer = exploration.answer("lying");
    const std::vector<NodeId>& walk = answer.plan.walk;
    for (std::size_t i = 1; i < walk.size(); ++i) {
      EXPECT_GE(answer.world.open().index_of(walk[i - 1], walk[i]), 0) << "a step that pictures do not have";
    }
    ASSERT_EQ(answer.discovered.after_step.size(), walk.size());
    EXPECT_TRUE(std::ranges::is_sorted(answer.discovered.after_step));
    EXPECT_EQ(answer.discovered.after_step.back(), std::ssize(answer.discovered.nodes));
    const GridMap map = std::get<GridMap>(exploration.map());
    EXPECT_EQ(map.free_count(), exploration.report().cells->seen);
  }
}

}  // namespace
}  // namespace graphdrl
