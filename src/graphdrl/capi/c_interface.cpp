// The C interface: handles around worlds and plans, and no exception past its edge.
#include <fmt/format.h>
#include <graphdrl/graphdrl_c.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <mutex>
#include <nlohmann/json.hpp>

#include "graphdrl/base/error.h"
#include "graphdrl/base/parallel.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/io/json.h"
#include "graphdrl/live/transcript.h"
#include "graphdrl/planners/bound.h"
#include "graphdrl/report/live_files.h"
#include "graphdrl/report/plan_files.h"

namespace graphdrl {

// What graphdrl_free() is given.
class Handle {
 public:
  Handle() = default;
  Handle(const Handle&) = delete;
  virtual ~Handle() = default;
};

namespace {

thread_local std::string last_error;

// Does the work, and turns what it throws into a status.
template <typename Work>
graphdrl_status guarded(const Work& work) noexcept {
  const auto failed = [](graphdrl_status status, const char* text) noexcept {
    try {
      last_error = text;
    } catch (...) {
      last_error.clear();
    }
    return status;
  };
  try {
    work();
    return GRAPHDRL_DONE;
  } catch (const MachineError& error) {
    return failed(GRAPHDRL_FAILED, error.what());
  } catch (const Error& error) {
    return failed(GRAPHDRL_BAD_INPUT, error.what());
  } catch (const std::bad_alloc&) {
    return failed(GRAPHDRL_FAILED, "out of memory");
  } catch (const std::exception& error) {
    return failed(GRAPHDRL_FAILED, error.what());
  } catch (...) {
    return failed(GRAPHDRL_FAILED, "an unknown failure");
  }
}

void require(const void* pointer, const char* what) {
  if (pointer == nullptr) throw Error({.what = std::string(what) + " is NULL"});
}

// The task with all fields there are, of a caller whose header may have had fewer.
graphdrl_task whole_task(const graphdrl_task* task) {
  require(task, "the task");
  if (task->size < offsetof(graphdrl_task, reveal)) {
    throw Error({.what = "bad size of a task", .expected = "graphdrl_task_init()"});
  }
  graphdrl_task whole;
  graphdrl_task_init(&whole);
  std::memcpy(&whole, task, std::min(task->size, sizeof whole));
  return whole;
}

Asked asked_of(const World& world, const graphdrl_task& task) {
  Asked asked;
  if (std::isnan(task.relative)) throw Error({.what = "the budget is not a number", .where = "relative"});
  // Not std::to_string(), which writes what the caller's locale says.
  if (task.relative > 0) {
    asked.budget = Budget::parse(fmt::format("{}x", task.relative));
  } else if (!(task.budget < 0)) {
    asked.budget = Budget(task.budget);
  }
  if (task.start != GRAPHDRL_GIVEN) asked.start = checked_node(world, task.start, "start");
  if (task.end == GRAPHDRL_ANYWHERE) asked.end = End::anywhere();
  if (task.end == GRAPHDRL_AT_START) asked.end = End::at_start();
  if (task.end != GRAPHDRL_GIVEN && !asked.end) asked.end = End::at(checked_node(world, task.end, "end"));
  return asked;
}

PlanRequest request_of(const graphdrl_task& task) {
  PlanRequest request{.seed = task.seed};
  if (task.reveal != nullptr) request.reveal = Reveal::parse(task.reveal);
  if (task.score != nullptr) request.score = parse_score(task.score);
  if (!(task.think_time_s < 0)) request.think_s = task.think_time_s;
  if (std::isnan(request.think_s)) throw Error({.what = "the think time is not a number"});
  if (task.policy != nullptr) request.policy = task.policy;
  return request;
}

std::optional<double> time_limit_of(const graphdrl_task& task) {
  return task.time_limit_s < 0 ? std::nullopt : std::optional(task.time_limit_s);
}

}  // namespace
}  // namespace graphdrl

struct graphdrl_world final : graphdrl::Handle {
  explicit graphdrl_world(graphdrl::World made) : world(std::move(made)) {}
  graphdrl::World world;
};

struct graphdrl_result final : graphdrl::Handle {
  explicit graphdrl_result(graphdrl::Answer made) : answer(std::move(made)) {}
  graphdrl::Answer answer;
  mutable std::once_flag json_made;
  mutable std::string json;
};

struct graphdrl_live final : graphdrl::Handle {
  explicit graphdrl_live(graphdrl::LiveRun begun) : run(std::move(begun)) {}
  graphdrl::LiveRun run;
  std::string answer;
};

using namespace graphdrl;

namespace {

// length: set to how many, where it is not NULL. No values: NULL and 0.
const int32_t* array_of(const std::vector<int32_t>* values, size_t* length) {
  if (length != nullptr) *length = values != nullptr ? values->size() : 0;
  return values != nullptr ? values->data() : nullptr;
}

bool explored(const graphdrl_result* result) {
  return result != nullptr && !result->answer.reveal.all();
}

}  // namespace

const char* graphdrl_version() {
  return GRAPHDRL_VERSION;
}

const char* graphdrl_last_error() {
  return last_error.c_str();
}

void graphdrl_free(void* handle) {
  delete static_cast<Handle*>(handle);
}

graphdrl_status graphdrl_set_threads(int32_t count) {
  return guarded([&] {
    if (count < 1 || count > 1024) {
      throw Error({.what = "bad number of threads", .expected = "1 to 1024", .got = std::to_string(count)});
    }
    set_threads(count);
  });
}

graphdrl_status graphdrl_world_from_edges(const char* name, int32_t node_count, size_t edge_count, const int32_t* edges,
                                          const double* costs, int32_t directed, const unsigned char* blocked,
                                          const double* prizes, graphdrl_world** world) {
  return guarded([&] {
    require(world, "the place for a world");
    *world = nullptr;
    if (edge_count > 0) require(edges, "the array of edges");
    const std::size_t nodes = node_count > 0 ? static_cast<std::size_t>(node_count) : 0;
    const std::vector<std::int64_t> ends(edges, edges + 2 * edge_count);
    const EdgeArrays arrays{.node_count = node_count,
                            .edges = ends,
                            .costs = {costs, costs != nullptr ? edge_count : 0},
                            .directed = directed != 0};
    GraphMap map;
    if (blocked != nullptr) map.blocked.assign(blocked, blocked + nodes);
    if (prizes != nullptr) map.prizes.assign(prizes, prizes + nodes);
    *world = new graphdrl_world(world_of(name != nullptr ? name : "graph", arrays, std::move(map)));
  });
}

graphdrl_status graphdrl_world_from_grid(const char* name, int32_t rows, int32_t columns, const unsigned char* blocked,
                                         int32_t diagonals, graphdrl_world** world) {
  return guarded([&] {
    require(world, "the place for a world");
    *world = nullptr;
    require(blocked, "the array of cells");
    const std::int64_t cells = std::int64_t{rows} * columns;
    if (rows < 1 || columns < 1 || cells > 1'000'000'000) {
      throw Error({.what = "bad size of a grid",
                   .expected = "1 to 1000000000 cells",
                   .got = std::to_string(rows) + " by " + std::to_string(columns)});
    }
    GridMap map{.rows = rows, .cols = columns, .blocked = {}, .diagonals = diagonals != 0};
    map.blocked.assign(blocked, blocked + cells);
    *world = new graphdrl_world(World(name != nullptr ? name : "grid", std::move(map)));
  });
}

graphdrl_status graphdrl_world_from_file(const char* path, graphdrl_world** world) {
  return guarded([&] {
    require(world, "the place for a world");
    *world = nullptr;
    require(path, "the path");
    *world = new graphdrl_world(load_one_world(path));
  });
}

const char* graphdrl_world_name(const graphdrl_world* world) {
  return world != nullptr ? world->world.name().c_str() : "";
}

int32_t graphdrl_world_node_count(const graphdrl_world* world) {
  return world != nullptr ? world->world.node_count() : 0;
}

int32_t graphdrl_world_valid_count(const graphdrl_world* world) {
  return world != nullptr ? world->world.valid_count() : 0;
}

const char* graphdrl_world_label(const graphdrl_world* world, int32_t node) {
  if (world == nullptr || node < 0 || node >= world->world.node_count()) return nullptr;
  const std::vector<std::string>& labels = world->world.labels();
  return labels.empty() ? nullptr : labels[static_cast<std::size_t>(node)].c_str();
}

int32_t graphdrl_world_find(const graphdrl_world* world, const char* label) {
  NodeId node = kNoNode;
  if (world != nullptr && label != nullptr) guarded([&] { node = parse_node(world->world, label, "node"); });
  return node;
}

void graphdrl_task_init_sized(graphdrl_task* task, size_t size) {
  if (task == nullptr) return;
  const graphdrl_task whole = {.size = size,
                               .budget = -1,
                               .relative = 0,
                               .start = GRAPHDRL_GIVEN,
                               .end = GRAPHDRL_GIVEN,
                               .policy = nullptr,
                               .time_limit_s = -1,
                               .seed = 1,
                               .progress = nullptr,
                               .progress_data = nullptr,
                               .reveal = nullptr,
                               .score = nullptr,
                               .think_time_s = -1,
                               .believed = nullptr};
  std::memcpy(task, &whole, std::min(size, sizeof whole));
}

graphdrl_status graphdrl_plan(const graphdrl_world* world, const graphdrl_task* task, graphdrl_result** result) {
  return guarded([&] {
    require(result, "the place for a result");
    *result = nullptr;
    require(world, "the world");
    const graphdrl_task whole = whole_task(task);
    const Task asked(world->world, asked_of(world->world, whole));
    PlanRequest request = request_of(whole);
    if (whole.believed != nullptr) request.believed = believe(whole.believed->world, world->world);
    // Tells the caller how far it is, until the caller stops it.
    std::atomic<bool> stopped = false;
    const ProgressListener listener = [&](const Progress& news) {
      if (whole.progress == nullptr || stopped) return;
      stopped = whole.progress(news.visited, news.bound, whole.progress_data) != 0;
    };
    const Clock clock(time_limit_of(whole), &stopped, &listener);
    *result = new graphdrl_result(make_plan(world->world, asked, request, clock));
  });
}

graphdrl_status graphdrl_upper_bound(const graphdrl_world* world, const graphdrl_task* task, double* bound) {
  return guarded([&] {
    require(bound, "the place for a bound");
    require(world, "the world");
    const graphdrl_task whole = whole_task(task);
    *bound = max_prize(Task(world->world, asked_of(world->world, whole)), Clock(time_limit_of(whole)));
  });
}

const int32_t* graphdrl_result_walk(const graphdrl_result* result, size_t* length) {
  return array_of(result != nullptr ? &result->answer.plan.walk : nullptr, length);
}

const int32_t* graphdrl_result_seen(const graphdrl_result* result, size_t* length) {
  return array_of(explored(result) ? &result->answer.discovered.nodes : nullptr, length);
}

const int32_t* graphdrl_result_seen_after_step(const graphdrl_result* result, size_t* length) {
  return array_of(explored(result) ? &result->answer.discovered.after_step : nullptr, length);
}

int32_t graphdrl_result_visited(const graphdrl_result* result) {
  return result != nullptr ? result->answer.plan.visited : 0;
}

double graphdrl_result_prize(const graphdrl_result* result) {
  return result != nullptr ? result->answer.plan.prize : 0;
}

double graphdrl_result_cost(const graphdrl_result* result) {
  return result != nullptr ? result->answer.plan.cost : 0;
}

double graphdrl_result_budget(const graphdrl_result* result) {
  return result != nullptr ? result->answer.task.budget() : 0;
}

double graphdrl_result_bound(const graphdrl_result* result) {
  return result != nullptr ? result->answer.plan.bound : 0;
}

int32_t graphdrl_result_optimal(const graphdrl_result* result) {
  return result != nullptr && result->answer.plan.optimal ? 1 : 0;
}

const char* graphdrl_result_json(const graphdrl_result* result) {
  if (result == nullptr) return "";
  const graphdrl_status made = guarded([&] {
    std::call_once(result->json_made, [&] {
      using Json = nlohmann::ordered_json;
      result->json = plan_json(result->answer).dump(-1, ' ', false, Json::error_handler_t::replace);
    });
  });
  return made == GRAPHDRL_DONE ? result->json.c_str() : "";
}

graphdrl_status graphdrl_result_save(const graphdrl_result* result, const char* path) {
  return guarded([&] {
    require(result, "the result");
    require(path, "the path");
    check_plan_file(result->answer.world, path);
    write_plan(result->answer, path);
  });
}

graphdrl_status graphdrl_live_begin(const char* options, const char* transcript, int32_t resume, graphdrl_live** live) {
  return guarded([&] {
    require(live, "the place for an exploration");
    *live = nullptr;
    if (resume != 0) require(transcript, "the transcript to go on with");
    const nlohmann::json asked = parse_json(options != nullptr ? options : "{}", "options", "an object");
    *live = new graphdrl_live(begin_live(parse_live_options(asked, LiveOptions()),
                                         {.file = transcript != nullptr ? transcript : "", .resume = resume != 0}));
  });
}

graphdrl_status graphdrl_live_answer(graphdrl_live* live, const char* message, const char** answer) {
  return guarded([&] {
    require(answer, "the place for an answer");
    *answer = nullptr;
    require(live, "the exploration");
    require(message, "the message");
    live->answer = live->run.session->answer(message);
    *answer = live->answer.c_str();
  });
}

graphdrl_status graphdrl_live_save(const graphdrl_live* live, const char* path) {
  return guarded([&] {
    require(live, "the exploration");
    require(path, "the path");
    if (live->run.session->exploration() == nullptr) throw Error({.what = "nothing was observed yet"});
    check_live_file(path);
    write_live(*live->run.session->exploration(), path);
  });
}
