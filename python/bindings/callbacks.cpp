#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>

#include "bindings.h"
#include "graphdrl/base/error.h"
#include "graphdrl/env/episode.h"
#include "graphdrl/env/task.h"

namespace graphdrl::python {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks(50);

// Python ends threads that ask for its lock while the interpreter ends, in the middle of C++, which aborts the process.
// So such a thread sleeps until the process is gone.
void wait_for_exit_where_python_ends() {
  while (Py_IsInitialized() == 0) std::this_thread::sleep_for(std::chrono::hours(1));
}

std::vector<NodeId> moves_of(const Observation& observation) {
  std::vector<NodeId> nodes;
  for (int action = 0; action < observation.action_count(); ++action) {
    if (observation.legal(action)) nodes.push_back(observation.target(action));
  }
  return nodes;
}

class CallablePolicy final : public Policy {
 public:
  explicit CallablePolicy(nb::object choose) : choose_(std::move(choose)) {}
  CallablePolicy(const CallablePolicy&) = delete;
  ~CallablePolicy() override {
    wait_for_exit_where_python_ends();
    const nb::gil_scoped_acquire lock;
    choose_.reset();
  }

  void act(std::span<const Observation> observations, std::span<int> actions, const Clock& clock) override {
    if (clock.stopped()) return std::fill(actions.begin(), actions.end(), kStop);
    wait_for_exit_where_python_ends();
    const nb::gil_scoped_acquire lock;
    for (std::size_t i = 0; i < observations.size(); ++i) actions[i] = action(observations[i]);
  }

 private:
  int action(const Observation& observation) {
    const nb::object state = nb::cast(State(observation));
    struct Closer {
      State& state;
      ~Closer() { state.close(); }
    } closer{nb::cast<State&>(state)};
    const nb::object answer = choose_(state);
    if (answer.is_none()) return kStop;
    std::int64_t node = kNoNode;
    if (!nb::try_cast(answer, node)) {
      throw Error({.what = "the policy gave no node",
                   .expected = "the number of a node, one of state.moves, or None",
                   .got = nb::cast<std::string>(nb::module_::import_("graphdrl.checks").attr("shown")(answer))});
    }
    for (int a = 0; a < observation.action_count(); ++a) {
      if (observation.target(a) == node && observation.affordable(a)) return a;
    }
    throw Error({.what = "the policy chose a node that no step leads to",
                 .expected = "one of state.moves, or None to stop",
                 .got = std::to_string(node)});
  }

  nb::object choose_;
};

}  // namespace

std::unique_ptr<Policy> make_callable_policy(nb::object choose) {
  return std::make_unique<CallablePolicy>(std::move(choose));
}

State::State(const World& world, std::span<const NodeId> walk, double budget, End end) {
  if (walk.empty()) throw Error({.what = "the walk is empty", .expected = "at least a start"});
  auto own = std::make_unique<Own>(
      Own{.episode = Episode(world, Task(world, walk.front(), budget, end), {.action_space = action_space_of(world)}),
          .observation = {}});
  follow_walk(own->episode, walk);
  own->observation = own->episode.observation();
  own_ = std::move(own);
  observation_ = &own_->observation;
}

const Observation& State::get() const {
  if (observation_ == nullptr) throw Error({.what = "this state is over", .expected = "one use, within the policy"});
  return *observation_;
}

void run_unlocked(const std::function<void()>& work, const std::function<void()>& listen,
                  const std::function<void()>& stop) {
  std::mutex mutex;
  std::condition_variable ended;
  bool done = false;
  std::exception_ptr failure;
  std::optional<nb::python_error> raised;
  const auto heed = [&] {
    try {
      if (PyErr_CheckSignals() != 0) nb::raise_python_error();
      listen();
    } catch (nb::python_error& error) {
      raised.emplace(std::move(error));
      stop();
    }
  };
  {
    const nb::gil_scoped_release unlocked;
    std::thread worker([&] {
      try {
        work();
      } catch (...) {
        failure = std::current_exception();
      }
      const std::lock_guard lock(mutex);
      done = true;
      ended.notify_one();
    });
    std::unique_lock lock(mutex);
    while (!ended.wait_for(lock, kBetweenLooks, [&] { return done; })) {
      if (Py_IsInitialized() == 0) stop();
      wait_for_exit_where_python_ends();
      if (raised) continue;
      lock.unlock();
      {
        const nb::gil_scoped_acquire locked;
        heed();
      }
      lock.lock();
    }
    lock.unlock();
    worker.join();
    wait_for_exit_where_python_ends();
  }
  if (!raised && !failure) heed();
  if (raised) throw std::move(*raised);
  if (failure) std::rethrow_exception(failure);
}

void run_planning(std::optional<double> time_limit, const nb::object& on_progress,
                  const std::function<void(const Clock&)>& work) {
  std::mutex mutex;
  std::optional<Progress> news;
  std::atomic<bool> stopped = false;
  const ProgressListener listener = [&](const Progress& progress) {
    const std::lock_guard lock(mutex);
    news = progress;
  };
  const auto listen = [&] {
    std::unique_lock lock(mutex);
    const std::optional<Progress> told = std::exchange(news, std::nullopt);
    lock.unlock();
    if (told && !on_progress.is_none()) on_progress(told->visited, told->bound);
  };
  const Clock clock(time_limit, &stopped, on_progress.is_none() ? nullptr : &listener);
  run_unlocked([&] { work(clock); }, listen, [&] { stopped = true; });
}

void bind_callbacks(nb::module_& module) {
  nb::class_<State>(module, "State",
                    "What a policy sees: a walk under way. Nodes are numbers.\n\nOne that a policy is given holds for "
                    "that call; after "
                    "it, every property raises Error. One of `World.state` lasts.")
      .def(
          "__init__",
          [](State* self, const World& world, const InArray<std::int64_t, nb::ndim<1>>& walk, const std::string& budget,
             std::optional<std::int64_t> end) {
            std::vector<NodeId> nodes;
            for (const std::int64_t node : values_of<std::int64_t>(walk)) {
              nodes.push_back(checked_node(world, node, "a step"));
            }
            new (self) State(world, nodes, Budget::parse(budget).cost_in(world),
                             end ? End::at(checked_node(world, *end, "end")) : End::anywhere());
          },
          nb::arg("world"), nb::arg("walk"), nb::arg("budget"), nb::arg("end").none())
      .def_prop_ro(
          "position", [](const State& state) { return state.get().position; }, "The number of the current node.")
      .def_prop_ro(
          "moves", [](const State& state) { return moves_of(state.get()); },
          "The numbers of the nodes that one step leads to, and that can be paid for, a list.")
      .def_prop_ro(
          "visits",
          [](const State& state) {
            return to_numpy(std::vector(state.get().visits.begin(), state.get().visits.end()));
          },
          nb::rv_policy::automatic, "How often each node was visited, a copy. Shape [N], uint32.")
      .def_prop_ro(
          "walk",
          [](const State& state) { return to_numpy(std::vector(state.get().walk.begin(), state.get().walk.end())); },
          nb::rv_policy::automatic, "Every position so far, the start first, a copy. Shape [steps + 1], int32.")
      .def_prop_ro(
          "visited_count", [](const State& state) { return state.get().visited_count; },
          "How many different nodes are visited, the start included.")
      .def_prop_ro(
          "budget", [](const State& state) { return state.get().task->budget(); },
          "What the whole walk may cost, in units of cost.")
      .def_prop_ro(
          "spent", [](const State& state) { return state.get().spent; },
          "What the walk has cost so far, in units of cost.")
      .def_prop_ro(
          "edges",
          [](const State& state) {
            std::vector<std::int64_t> ends;
            for (const Edge& edge : state.get().view().open().edges()) ends.insert(ends.end(), {edge.a, edge.b});
            return to_numpy(std::move(ends), 2);
          },
          nb::rv_policy::automatic,
          "The edges known, without those of blocked nodes, from and to; in an undirected graph they lead both ways. "
          "Shape [E, 2], int64.")
      .def_prop_ro(
          "edge_costs",
          [](const State& state) {
            std::vector<double> costs;
            for (const Edge& edge : state.get().view().open().edges()) costs.push_back(edge.cost);
            return to_numpy(std::move(costs));
          },
          nb::rv_policy::automatic, "What each of these edges costs. Shape [E], float64.")
      .def_prop_ro(
          "prizes",
          [](const State& state) {
            const View& view = state.get().view();
            std::vector<double> prizes;
            for (NodeId node = 0; node < view.node_count(); ++node) prizes.push_back(view.prize(node));
            return to_numpy(std::move(prizes));
          },
          nb::rv_policy::automatic, "What the first visit of each node is worth. Shape [N], float64.")
      .def_prop_ro(
          "places",
          [](const State& state) {
            std::vector<double> places;
            for (const Point& place : state.get().view().places()) places.insert(places.end(), {place.x, place.y});
            return to_numpy(std::move(places), 2);
          },
          nb::rv_policy::automatic,
          "Where each node seen lies, x and y, y upward. Shape [N, 2], float64. [0, 2] in a known map, of which "
          "World.places says it, and where the world does not say.")
      .def_prop_ro(
          "frontier",
          [](const State& state) {
            const View& view = state.get().view();
            std::vector<NodeId> nodes;
            for (NodeId node = 0; node < view.node_count(); ++node) {
              if (view.is_frontier(node)) nodes.push_back(node);
            }
            return to_numpy(std::move(nodes));
          },
          nb::rv_policy::automatic,
          "The numbers of the nodes that may have edges that are not known, ascending, int32. None of a known map.")
      .def_prop_ro(
          "seen_at",
          [](const State& state) {
            const View& view = state.get().view();
            std::vector<std::uint32_t> visits(view.node_count());
            for (NodeId node = 0; view.grows() && node < view.node_count(); ++node) visits[node] = view.seen_at(node);
            return to_numpy(std::move(visits));
          },
          nb::rv_policy::automatic,
          "When each node was last seen, counted in first visits; 0 of a known map. Shape [N], uint32.");
}

}  // namespace graphdrl::python
