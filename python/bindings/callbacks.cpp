#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>

#include "bindings.h"
#include "graphdrl/base/error.h"

namespace graphdrl::python {
namespace {

constexpr std::chrono::milliseconds kBetweenLooks(50);

// What a policy in Python is shown. Holds for one call: then the episode goes on.
class State {
 public:
  explicit State(const Observation& observation) : observation_(&observation) {}

  void close() { observation_ = nullptr; }
  NodeId position() const { return get().position; }
  double spent() const { return get().spent; }
  double budget() const { return get().budget; }
  int visited_count() const { return get().visited_count; }

  std::vector<NodeId> moves() const {
    std::vector<NodeId> nodes;
    for (int action = 0; action < get().action_count(); ++action) {
      if (get().legal(action)) nodes.push_back(get().target(action));
    }
    return nodes;
  }
  OutArray<std::uint32_t> visits() const { return to_numpy(std::vector(get().visits.begin(), get().visits.end())); }
  OutArray<NodeId> walk() const { return to_numpy(std::vector(get().walk.begin(), get().walk.end())); }

 private:
  const Observation& get() const {
    if (observation_ == nullptr) throw Error({.what = "this state is over", .expected = "one use, within the policy"});
    return *observation_;
  }

  const Observation* observation_;
};

class CallablePolicy final : public Policy {
 public:
  explicit CallablePolicy(nb::object choose) : choose_(std::move(choose)) {}
  CallablePolicy(const CallablePolicy&) = delete;
  ~CallablePolicy() override {
    const nb::gil_scoped_acquire lock;
    choose_.reset();
  }

  void act(std::span<const Observation> observations, std::span<int> actions) override {
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
    if (!nb::try_cast(answer, node)) throw Error({.what = "the policy gave no node", .expected = "a node or None"});
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

void run_unlocked(const nb::object& on_progress, const std::function<void(const Report&)>& work) {
  std::mutex mutex;
  std::condition_variable ended;
  bool done = false;
  std::exception_ptr failure;
  std::optional<PlanProgress> news;
  const bool listens = !on_progress.is_none();
  Report report;
  if (listens) {
    report = [&](const PlanProgress& progress) {
      const std::lock_guard lock(mutex);
      news = progress;
    };
  }
  std::optional<nb::python_error> raised;
  {
    const nb::gil_scoped_release unlocked;
    std::thread worker([&] {
      try {
        work(report);
      } catch (...) {
        failure = std::current_exception();
      }
      const std::lock_guard lock(mutex);
      done = true;
      ended.notify_one();
    });
    std::unique_lock lock(mutex);
    while (!ended.wait_for(lock, kBetweenLooks, [&] { return done; })) {
      if (raised) continue;
      const std::optional<PlanProgress> told = std::exchange(news, std::nullopt);
      lock.unlock();
      {
        const nb::gil_scoped_acquire locked;
        try {
          if (PyErr_CheckSignals() != 0) nb::raise_python_error();
          if (told) on_progress(told->visited, told->bound);
        } catch (nb::python_error& error) {
          raised.emplace(std::move(error));
          stop_planning();
        }
      }
      lock.lock();
    }
    lock.unlock();
    worker.join();
  }
  if (raised) {
    stop_planning(false);
    throw std::move(*raised);
  }
  if (failure) std::rethrow_exception(failure);
}

void bind_callbacks(nb::module_& module) {
  nb::class_<State>(module, "State", "What a policy sees: node numbers and costs. It holds for one call of the policy.")
      .def_prop_ro("position", &State::position, "The node it stands on.")
      .def_prop_ro("moves", &State::moves, "The nodes that one step leads to, and that can be paid for.")
      .def_prop_ro("visits", &State::visits, nb::rv_policy::automatic,
                   "How often each node was visited. Shape [N], uint32.")
      .def_prop_ro("walk", &State::walk, nb::rv_policy::automatic,
                   "Every position so far, the start first. Shape [steps + 1], int32.")
      .def_prop_ro("visited_count", &State::visited_count, "How many nodes are visited.")
      .def_prop_ro("budget", &State::budget, "Of the whole walk, in units of cost.")
      .def_prop_ro("spent", &State::spent, "Of the budget.");
}

}  // namespace graphdrl::python
