// What the parts of the extension share.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

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

template <typename T, typename Array>
std::span<const T> values_of(const Array& array) {
  return {array.data(), array.size()};
}

// A node by its number. Throws Error, with the node's role, where there is no such valid node.
NodeId checked_node(const World& world, std::int64_t node, std::string_view role);

// Runs work on a thread of its own, without the interpreter's lock, and passes its reports on to Python some twenty
// times a second: on_progress(visited, bound) where it is not None. Where that raises, or the user presses Ctrl-C, all
// planning of the process stops, and the exception is raised here.
void run_unlocked(const nb::object& on_progress, const std::function<void(const Report&)>& work);

// A callable as a policy: choose(state) gives the number of the node to go to, or None to stop.
std::unique_ptr<Policy> make_callable_policy(nb::object choose);

}  // namespace graphdrl::python
