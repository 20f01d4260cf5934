// The extension: the library in Python's words. python/graphdrl/ makes it comfortable.
#include <exception>

#include "bindings.h"
#include "graphdrl/base/error.h"
#include "graphdrl/base/note.h"
#include "graphdrl/base/parallel.h"

namespace graphdrl::python {

NB_MODULE(_core, module) {
  // Globals and cycles that are still alive when Python ends are no leaks; do not report them.
  nb::set_leak_warnings(false);
  module.doc() = "The extension behind the package graphdrl.";
  module.attr("__version__") = GRAPHDRL_VERSION;
  nb::exception<Error>(module, "Error", PyExc_ValueError).doc() =
      "What a caller can get wrong: an argument, a file. A ValueError whose text is one line.";
  nb::exception<MachineError>(module, "MachineError", PyExc_OSError).doc() =
      "What the machine refused: disk, memory, threads. An OSError whose text is one line.";
  // Also from threads that Python does not know.
  listen_to_notes([](const std::string& text) {
    const nb::gil_scoped_acquire gil;
    if (PyErr_WarnEx(PyExc_UserWarning, text.c_str(), 2) != 0) throw nb::python_error();
  });
  module.def(
      "set_threads",
      [](int count) {
        if (count < 1 || count > 1024) {
          throw Error({.what = "bad number of threads", .expected = "1 to 1024", .got = std::to_string(count)});
        }
        set_threads(count);
      },
      nb::arg("count"),
      "Sets how many threads one call may use: 1 to 1024, 1 at first. Results do not depend on it. Raises Error.");
  module.def("threads", &threads, "How many threads one call may use.");
  bind_worlds(module);
  bind_callbacks(module);
  bind_policies(module);
  bind_planning(module);
  bind_evaluation(module);
  bind_environments(module);
  bind_training(module);
  bind_live(module);
}

}  // namespace graphdrl::python
