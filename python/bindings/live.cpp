#include <nlohmann/json.hpp>
#include <utility>
#include <variant>

#include "bindings.h"
#include "graphdrl/base/error.h"
#include "graphdrl/io/json.h"
#include "graphdrl/live/transcript.h"
#include "graphdrl/report/live_files.h"

namespace graphdrl::python {
namespace {

const LiveExploration& begun(const LiveRun& run) {
  const LiveExploration* const exploration = run.session->exploration();
  if (exploration == nullptr) throw Error({.what = "nothing was observed yet"});
  return *exploration;
}

LiveRun begin(const std::string& options, const std::string& transcript, bool sync, bool resume) {
  return begin_live(parse_live_options(parse_json(options, "options"), LiveOptions()),
                    {.file = transcript, .sync = sync, .resume = resume});
}

// The policy may think for long.
std::string answer(LiveRun& run, const std::string& message) {
  const nb::gil_scoped_release unlocked;
  return run.session->answer(message);
}

}  // namespace

void bind_live(nb::module_& module) {
  nb::class_<LiveRun>(module, "LiveRun", "A live exploration: messages and answers as JSON, docs/live.md.")
      .def(
          "__init__",
          [](LiveRun* self, const std::string& options, const std::string& transcript, bool sync, bool resume) {
            new (self) LiveRun(begin(options, transcript, sync, resume));
          },
          nb::arg("options"), nb::arg("transcript"), nb::arg("sync"), nb::arg("resume"))
      .def("answer", &answer, nb::arg("message"))
      .def_prop_ro("last_answer", [](const LiveRun& run) { return run.session->last_answer(); })
      .def("report", [](const LiveRun& run) { return live_report_json(begun(run).report()).dump(); })
      .def("plan", [](const LiveRun& run) { return begun(run).answer("live"); })
      .def("world",
           [](const LiveRun& run) {
             return std::visit([](auto map) { return World("live", std::move(map)); }, begun(run).map());
           })
      .def(
          "save",
          [](const LiveRun& run, const std::string& file) {
            check_live_file(file);
            write_live(begun(run), file);
          },
          nb::arg("path"));
}

}  // namespace graphdrl::python
