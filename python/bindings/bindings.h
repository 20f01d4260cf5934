// What the parts of the extension share.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "graphdrl/env/episode.h"
#include "graphdrl/env/load_worlds.h"
#include "graphdrl/env/policy.h"
#include "graphdrl/env/world.h"
#include "graphdrl/planners/plan.h"

namespace graphdrl::python {

namespace nb = nanobind;

void bind_worlds(nb::module_& module);
void bind_planning(nb::module_& module);
void bind_callbacks(nb::module_& module);
void bind_environments(nb::module_& module);
void bind_evaluation(nb::module_& module);
void bind_policies(nb::module_& module);
void bind_training(nb::module_& module);
void bind_live(nb::module_& module);

template <typename T, typename... Shape>
using InArray = nb::ndarray<const T, nb::c_contig, nb::device::cpu, Shape...>;
template <typename T>
using OutArray = nb::ndarray<nb::numpy, T, nb::ndim<1>>;

// The values as an array of NumPy, which takes them over.
template <typename T>
OutArray<T> to_numpy(std::vector<T> values) {
  auto* const owned = new std::vector<T>(std::move(values));
  const nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return OutArray<T>(owned->data(), {owned->size()}, owner);
}

// The same as rows of so many.
template <typename T>
nb::ndarray<nb::numpy, T, nb::ndim<2>> to_numpy(std::vector<T> values, std::size_t columns) {
  auto* const owned = new std::vector<T>(std::move(values));
  const nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return nb::ndarray<nb::numpy, T, nb::ndim<2>>(owned->data(), {owned->size() / columns, columns}, owner);
}

template <typename T, typename Array>
std::span<const T> values_of(const Array& array) {
  return {array.data(), array.size()};
}

// Runs work on a thread of its own, without the interpreter's lock. Calls listen() with it some twenty times a second,
// and once when the work is done. Where that raises, or the user presses Ctrl-C, calls stop(), which must make the work
// end, and raises the exception here then.
void run_unlocked(const std::function<void()>& work, const std::function<void()>& listen,
                  const std::function<void()>& stop);

// The same for planning within a time limit, in seconds. The clock's listener is on_progress(visited, bound), unless it
// is None. A stop ends this planning and no other.
void run_planning(std::optional<double> time_limit, const nb::object& on_progress,
                  const std::function<void(const Clock&)>& work);

// What a policy is shown: an episode under way, for one call of the policy; or the state after a walk, which lasts.
class State {
 public:
  explicit State(const Observation& observation) : observation_(&observation) {}
  // Throws Error where the walk cannot be walked.
  State(const World& world, std::span<const NodeId> walk, double budget, End end);

  void close() { observation_ = nullptr; }
  const Observation& get() const;  // throws Error once closed

 private:
  struct Own {
    Episode episode;
    Observation observation;
  };

  std::unique_ptr<const Own> own_;
  const Observation* observation_;
};

// A policy that is no name: an explorer, a network of the paper, or a callable that is given a State and gives the
// number of the node to go to, or None to stop. One of the two is set. REQUIRES: the object outlives it.
struct OwnPolicy {
  std::function<std::unique_ptr<Planner>()> planner;
  std::function<std::unique_ptr<Policy>()> policy;

  std::unique_ptr<Policy> as_policy() const;  // whichever it is
};
OwnPolicy own_policy_of(nb::handle policy);
std::unique_ptr<Policy> make_callable_policy(nb::object choose);

}  // namespace graphdrl::python
