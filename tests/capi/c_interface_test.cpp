// The C interface as a caller sees it; and that its results are those of the modules behind it.
#include <graphdrl/graphdrl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string>
#include <thread>

namespace {

// Frees what it holds.
template <typename T>
struct Owned {
  T* handle = nullptr;
  Owned() = default;
  Owned(const Owned&) = delete;
  ~Owned() { graphdrl_free(handle); }
};

// A path of four nodes whose edges cost 1, 2 and 4.
constexpr std::int32_t kPath[] = {0, 1, 1, 2, 2, 3};
constexpr double kCosts[] = {1, 2, 4};

graphdrl_status make_path(Owned<graphdrl_world>& world) {
  return graphdrl_world_from_edges("path", 4, 3, kPath, kCosts, 0, nullptr, nullptr, &world.handle);
}

graphdrl_task task_of(double budget) {
  graphdrl_task task;
  graphdrl_task_init(&task);
  task.budget = budget;
  return task;
}

TEST(CInterface, PlansAPathWorkedOutByHand) {
  Owned<graphdrl_world> world;
  ASSERT_EQ(make_path(world), GRAPHDRL_DONE);
  EXPECT_STREQ(graphdrl_world_name(world.handle), "path");
  EXPECT_EQ(graphdrl_world_node_count(world.handle), 4);
  EXPECT_EQ(graphdrl_world_find(world.handle, "3"), 3);
  EXPECT_EQ(graphdrl_world_find(world.handle, "4"), -1);
  EXPECT_EQ(graphdrl_world_label(world.handle, 0), nullptr);

  // From 1: back to 0 and on to 2 costs 1 + 1 + 2 = 4; node 3 would cost 8.
  graphdrl_task task = task_of(5);
  task.start = 1;
  Owned<graphdrl_result> result;
  ASSERT_EQ(graphdrl_plan(world.handle, &task, &result.handle), GRAPHDRL_DONE) << graphdrl_last_error();
  std::size_t length = 0;
  const std::int32_t* const walk = graphdrl_result_walk(result.handle, &length);
  EXPECT_EQ(std::vector<std::int32_t>(walk, walk + length), (std::vector<std::int32_t>{1, 0, 1, 2}));
  EXPECT_EQ(graphdrl_result_visited(result.handle), 3);
  EXPECT_EQ(graphdrl_result_prize(result.handle), 3);
  EXPECT_EQ(graphdrl_result_cost(result.handle), 4);
  EXPECT_EQ(graphdrl_result_budget(result.handle), 5);
  EXPECT_EQ(graphdrl_result_bound(result.handle), 3);
  EXPECT_EQ(graphdrl_result_optimal(result.handle), 1);
  EXPECT_NE(std::string(graphdrl_result_json(result.handle)).find("\"walk\":[1,0,1,2]"), std::string::npos);

  // Back home: 1 - 0 - 1 costs 2, 1 - 2 - 1 costs 4; both cost 6.
  task.end = GRAPHDRL_AT_START;
  task.budget = 6;
  double bound = 0;
  ASSERT_EQ(graphdrl_upper_bound(world.handle, &task, &bound), GRAPHDRL_DONE);
  EXPECT_EQ(bound, 3);
}

// From 1, where 0 and 2 are seen: to 0, back and on to 2, where 3 is seen.
TEST(CInterface, ExploresAPathWorkedOutByHand) {
  Owned<graphdrl_world> world;
  ASSERT_EQ(make_path(world), GRAPHDRL_DONE);
  graphdrl_task task = task_of(5);
  task.start = 1;
  task.reveal = "edges";
  Owned<graphdrl_result> result;
  ASSERT_EQ(graphdrl_plan(world.handle, &task, &result.handle), GRAPHDRL_DONE) << graphdrl_last_error();
  const auto array = [&](const auto& of) {
    std::size_t length = 0;
    const std::int32_t* const values = of(result.handle, &length);
    return std::vector<std::int32_t>(values, values + length);
  };
  EXPECT_EQ(array(graphdrl_result_walk), (std::vector<std::int32_t>{1, 0, 1, 2}));
  EXPECT_EQ(array(graphdrl_result_seen_after_step), (std::vector<std::int32_t>{3, 3, 3, 4}));
  const std::vector<std::int32_t> seen = array(graphdrl_result_seen);
  ASSERT_EQ(seen.size(), 4u);
  EXPECT_EQ(seen.front(), 1);
  EXPECT_EQ(seen.back(), 3);
  EXPECT_EQ(graphdrl_result_bound(result.handle), 3);
  EXPECT_NE(std::string(graphdrl_result_json(result.handle)).find("\"policy\":\"explorer\""), std::string::npos);
}

// The old map is a path from 0 to 5; since then an edge from 0 to 4 came. From 0 both 1 and 4 are seen.
TEST(CInterface, ExploresByAnOldMap) {
  Owned<graphdrl_world> world;
  Owned<graphdrl_world> old;
  const std::vector<std::int32_t> edges = {0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 0, 4};
  ASSERT_EQ(graphdrl_world_from_edges("now", 6, 6, edges.data(), nullptr, 0, nullptr, nullptr, &world.handle),
            GRAPHDRL_DONE);
  ASSERT_EQ(graphdrl_world_from_edges("old", 6, 5, edges.data(), nullptr, 0, nullptr, nullptr, &old.handle),
            GRAPHDRL_DONE);
  graphdrl_task task = task_of(5);
  task.reveal = "edges";
  task.believed = old.handle;
  Owned<graphdrl_result> result;
  ASSERT_EQ(graphdrl_plan(world.handle, &task, &result.handle), GRAPHDRL_DONE) << graphdrl_last_error();
  std::size_t length = 0;
  const std::int32_t* const walk = graphdrl_result_walk(result.handle, &length);
  EXPECT_EQ(std::vector<std::int32_t>(walk, walk + length), (std::vector<std::int32_t>{0, 1, 2, 3, 4, 5}));
  EXPECT_NE(std::string(graphdrl_result_json(result.handle)).find("\"policy\":\"search:10000\""), std::string::npos);
  graphdrl_result* none = nullptr;
  task.reveal = nullptr;
  EXPECT_EQ(graphdrl_plan(world.handle, &task, &none), GRAPHDRL_BAD_INPUT);
  EXPECT_EQ(std::string(graphdrl_last_error()),
            "an old map goes with a map that is not known, and with a policy that plans");
  task.reveal = "edges";
  Owned<graphdrl_world> cells;
  const std::vector<unsigned char> blocked(6);
  ASSERT_EQ(graphdrl_world_from_grid("cells", 2, 3, blocked.data(), 0, &cells.handle), GRAPHDRL_DONE);
  task.believed = cells.handle;
  EXPECT_EQ(graphdrl_plan(world.handle, &task, &none), GRAPHDRL_BAD_INPUT);
  EXPECT_NE(std::string(graphdrl_last_error()).find("the believed map is of another kind"), std::string::npos);
}

// What stands behind the fields of an older header is not looked at.
TEST(CInterface, TakesTheTaskOfAnOlderHeader) {
  Owned<graphdrl_world> world;
  ASSERT_EQ(make_path(world), GRAPHDRL_DONE);
  graphdrl_task task;
  std::memset(&task, 0x55, sizeof task);
  graphdrl_task_init_sized(&task, offsetof(graphdrl_task, reveal));
  task.budget = 7;
  Owned<graphdrl_result> result;
  ASSERT_EQ(graphdrl_plan(world.handle, &task, &result.handle), GRAPHDRL_DONE) << graphdrl_last_error();
  EXPECT_EQ(graphdrl_result_visited(result.handle), 4);
  std::size_t length = 7;
  EXPECT_EQ(graphdrl_result_seen(result.handle, &length), nullptr) << "the map was known";
  EXPECT_EQ(length, 0u);
}

TEST(CInterface, ResultsOutliveTheirWorld) {
  Owned<graphdrl_result> result;
  {
    Owned<graphdrl_world> world;
    ASSERT_EQ(make_path(world), GRAPHDRL_DONE);
    const graphdrl_task task = task_of(7);
    ASSERT_EQ(graphdrl_plan(world.handle, &task, &result.handle), GRAPHDRL_DONE);
  }
  EXPECT_EQ(graphdrl_result_visited(result.handle), 4);
  EXPECT_NE(std::string(graphdrl_result_json(result.handle)).find("\"map\":\"path\""), std::string::npos);
}

TEST(CInterface, SaysInOneLineWhatIsWrong) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Owned<graphdrl_world> path;
  ASSERT_EQ(make_path(path), GRAPHDRL_DONE);
  const auto refused = [](graphdrl_status status, const std::string& why) {
    EXPECT_EQ(status, GRAPHDRL_BAD_INPUT) << why;
    const std::string text = graphdrl_last_error();
    EXPECT_NE(text.find(why), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  };
  const auto edges = [&](std::int32_t nodes, std::int32_t second, double cost, const double* prizes) {
    const std::int32_t ends[] = {0, second};
    graphdrl_world* world = path.handle;  // must not stay
    const graphdrl_status status =
        graphdrl_world_from_edges(nullptr, nodes, 1, ends, &cost, 0, nullptr, prizes, &world);
    EXPECT_EQ(world, nullptr);
    return status;
  };
  refused(edges(2, 2, 1, nullptr), "an edge outside the graph");
  refused(edges(2, -1, 1, nullptr), "an edge outside the graph");
  refused(edges(0, 1, 1, nullptr), "bad number of nodes");
  refused(edges(-5, 1, 1, nullptr), "bad number of nodes");
  refused(edges(2, 1, nan, nullptr), "cost");
  refused(edges(2, 1, -1, nullptr), "cost");
  const double prizes[] = {1, nan};
  refused(edges(2, 1, 1, prizes), "bad prize");

  graphdrl_world* world = nullptr;
  const unsigned char cells[4] = {1, 1, 1, 1};
  refused(graphdrl_world_from_grid(nullptr, 2, 2, cells, 0, &world), "no valid node");
  refused(graphdrl_world_from_grid(nullptr, 0, 2, cells, 0, &world), "bad size of a grid");
  refused(graphdrl_world_from_grid(nullptr, 2, 2, nullptr, 0, &world), "NULL");
  refused(graphdrl_world_from_file("no-such-map", &world), "no such map");
  refused(graphdrl_world_from_file("paper:a", nullptr), "NULL");

  const auto plan = [&](const auto& change) {
    graphdrl_task task = task_of(3);
    change(task);
    graphdrl_result* result = nullptr;
    const graphdrl_status status = graphdrl_plan(path.handle, &task, &result);
    EXPECT_EQ(result, nullptr);
    return status;
  };
  refused(plan([&](graphdrl_task& task) { task.budget = nan; }), "budget");
  refused(plan([&](graphdrl_task& task) { task.relative = nan; }), "budget");
  refused(plan([&](graphdrl_task& task) { task.budget = -1; }), "no budget is given");
  refused(plan([&](graphdrl_task& task) { task.start = 4; }), "start outside the map");
  refused(plan([&](graphdrl_task& task) { task.start = -7; }), "start outside the map");
  refused(plan([&](graphdrl_task& task) { task.end = 99; }), "end outside the map");
  refused(plan([&](graphdrl_task& task) { task.policy = "magic"; }), "magic");
  refused(plan([&](graphdrl_task& task) { task.time_limit_s = nan; }), "bad time limit");
  refused(plan([&](graphdrl_task& task) { task.size = 1; }), "bad size of a task");
  refused(plan([&](graphdrl_task& task) { task.reveal = "smell"; }), "bad reveal");
  refused(plan([&](graphdrl_task& task) { task.reveal = "sight:3"; }), "sight needs a map of cells");
  refused(plan([&](graphdrl_task& task) { task.score = "heard"; }), "bad score");
  refused(plan([&](graphdrl_task& task) { task.think_time_s = nan; }), "think time");
  graphdrl_result* result = nullptr;
  refused(graphdrl_plan(nullptr, nullptr, &result), "NULL");
  refused(graphdrl_set_threads(0), "bad number of threads");
  refused(graphdrl_result_save(nullptr, "walk.json"), "NULL");
}

// 0.12345678 of 10,000 valid nodes; six digits would give one step less.
TEST(CInterface, TakesRelativeBudgetsToTheLastDigit) {
  const std::vector<unsigned char> cells(100 * 100, 0);
  Owned<graphdrl_world> world;
  ASSERT_EQ(graphdrl_world_from_grid(nullptr, 100, 100, cells.data(), 0, &world.handle), GRAPHDRL_DONE);
  graphdrl_task task = task_of(-1);
  task.relative = 0.12349999;
  task.policy = "nearest";
  Owned<graphdrl_result> result;
  ASSERT_EQ(graphdrl_plan(world.handle, &task, &result.handle), GRAPHDRL_DONE) << graphdrl_last_error();
  EXPECT_EQ(graphdrl_result_budget(result.handle), 1234);
}

// A header of an older version has a smaller struct: what follows it stays.
TEST(CInterface, InitialisesNoMoreThanTheCallersStruct) {
  graphdrl_task task;
  std::memset(&task, 0x55, sizeof task);
  graphdrl_task_init_sized(&task, offsetof(graphdrl_task, policy));
  EXPECT_EQ(task.start, GRAPHDRL_GIVEN);
  EXPECT_EQ(task.seed, 0x5555555555555555u);
}

TEST(CInterface, AnswersForNothing) {
  graphdrl_free(nullptr);
  graphdrl_task_init(nullptr);
  std::size_t length = 7;
  EXPECT_EQ(graphdrl_result_walk(nullptr, &length), nullptr);
  EXPECT_EQ(length, 0u);
  EXPECT_EQ(graphdrl_result_seen(nullptr, nullptr), nullptr);
  EXPECT_STREQ(graphdrl_result_json(nullptr), "");
  EXPECT_EQ(graphdrl_result_visited(nullptr), 0);
  EXPECT_STREQ(graphdrl_world_name(nullptr), "");
  EXPECT_EQ(graphdrl_world_valid_count(nullptr), 0);
  EXPECT_EQ(graphdrl_world_find(nullptr, "0"), -1);
}

// Plans that are stopped at their first report, on threads beside others that are not: these are not cut short.
TEST(CInterface, StopsOnePlanAndNoOtherThread) {
  std::vector<unsigned char> cells(30 * 30, 0);
  for (std::size_t i = 0; i < cells.size(); i += 7) cells[i] = 1;
  const auto world = graphdrl::World::from_grid(30, 30, cells);
  const auto task = graphdrl::Task(500).from(1).policy("search:20000");
  const graphdrl::Plan alone = graphdrl::plan(world, task);
  std::atomic<bool> done = false;
  std::thread stopping([&] {
    while (!done) {
      graphdrl::Task stopped = task;
      int told = 0;
      stopped.progress([&](int, double) { return ++told < 2; });
      const graphdrl::Plan plan = graphdrl::plan(world, stopped);
      EXPECT_LE(plan.visited(), alone.visited());
      EXPECT_EQ(told, 2);
    }
  });
  const graphdrl::Plan beside = graphdrl::plan(world, task);
  done = true;
  stopping.join();
  EXPECT_EQ(beside.walk(), alone.walk());
}

TEST(CppHeader, ExploresUntilNothingIsLeft) {
  const auto world = graphdrl::World::from_edges({{0, 1, 1}, {1, 2, 2}, {2, 3, 4}});
  const graphdrl::Plan visited = graphdrl::plan(world, graphdrl::Task().from(1).until_covered().reveal("edges"));
  EXPECT_EQ(visited.walk(), (std::vector<std::int32_t>{1, 0, 1, 2, 3}));
  EXPECT_EQ(visited.seen_after_step(), (std::vector<std::int32_t>{3, 3, 3, 4, 4}));
  const graphdrl::Plan seen =
      graphdrl::plan(world, graphdrl::Task(4).from(1).reveal("edges").count_seen().policy("search").think(0.01));
  EXPECT_EQ(seen.prize(), 4);
  EXPECT_EQ(seen.seen().size(), 4u);
  EXPECT_TRUE(std::isinf(seen.bound()));
  EXPECT_TRUE(graphdrl::plan(world, graphdrl::Task(4)).seen().empty());
  const graphdrl::Plan by_old_map = graphdrl::plan(world, graphdrl::Task(8).from(1).reveal("edges").believed(world));
  EXPECT_EQ(by_old_map.walk(), (std::vector<std::int32_t>{1, 0, 1, 2, 3}));
}

TEST(CppHeader, ExploresLive) {
  const auto folder = std::filesystem::temp_directory_path() / ("graphdrl_live_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  graphdrl::LiveExploration live(R"({"cover":"edges","reset_cost":1})", folder / "transcript");
  EXPECT_EQ(live.answer(R"({"id":1,"state":"a","moves":["x"]})"), R"({"id":1,"move":"x"})");
  const std::string done = live.answer(R"({"id":2,"state":"b","moves":[]})");
  EXPECT_EQ(done.find(R"({"id":2,"done":"covered")"), 0u) << done;
  EXPECT_NE(live.answer("nonsense").find("\"error\""), std::string::npos);
  live.save(folder / "map.graphml");
  EXPECT_EQ(graphdrl::World::from_file(folder / "map.graphml").node_count(), 2);
  graphdrl::LiveExploration again("{}", folder / "transcript", /*resume=*/true);
  EXPECT_EQ(again.answer(R"({"id":2,"state":"?"})"), done) << "an id that comes again";
  EXPECT_THROW(graphdrl::LiveExploration("{}", folder / "transcript"), graphdrl::Error);
  EXPECT_THROW(graphdrl::LiveExploration(R"({"cover":"faces"})"), graphdrl::Error);
  EXPECT_THROW(graphdrl::LiveExploration().save(folder / "none.dot"), graphdrl::Error);
  std::filesystem::remove_all(folder);
}

TEST(CppHeader, ThrowsWhatGoesWrongAndWhatProgressThrows) {
  const auto world = graphdrl::World::from_edges({{0, 1, 2.5}, {1, 2}});
  EXPECT_EQ(world.node_count(), 3);
  EXPECT_EQ(world.label(2), "2");
  EXPECT_EQ(graphdrl::plan(world, graphdrl::Task(3.5)).walk(), (std::vector<std::int32_t>{0, 1, 2}));
  EXPECT_EQ(graphdrl::upper_bound(world, graphdrl::Task(3.4)), 2);
  try {
    graphdrl::World::from_file("no-such-map");
    FAIL();
  } catch (const graphdrl::Error& error) {
    EXPECT_TRUE(error.bad_input());
  }
  graphdrl::GraphOptions options;
  options.prizes = {1, 2};
  EXPECT_THROW(graphdrl::World::from_edges({{0, 1}, {1, 2}}, options), graphdrl::Error);
  const auto map = graphdrl::World::from_file("paper:a");
  const auto task =
      graphdrl::Task::relative(1.1).progress([](int, double) -> bool { throw std::length_error("mine"); });
  EXPECT_THROW(graphdrl::plan(map, task), std::length_error);
}

}  // namespace
