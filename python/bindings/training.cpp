#include <atomic>
#include <cmath>
#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>

#include "bindings.h"
#include "graphdrl/train/trainer.h"

namespace graphdrl::python {
namespace {

using Row = std::vector<std::pair<std::string, double>>;

nb::dict dict_of(const Row& row) {
  nb::dict out;
  for (const auto& [name, value] : row) {
    const bool whole = &name == &row.front().first;  // the count
    out[name.c_str()] = whole               ? nb::object(nb::int_(static_cast<std::int64_t>(value)))
                        : std::isnan(value) ? nb::object(nb::none())
                                            : nb::object(nb::float_(value));
  }
  return out;
}

// Trains to the end, or until on_metrics(row) answers something true, raises, or the user presses Ctrl-C: everything is
// saved in any case. Gives whether the training is finished.
bool train(Trainer& trainer, const nb::object& on_metrics) {
  std::mutex mutex;
  std::deque<Row> news;
  std::atomic<bool> stopped = false;
  bool finished = false;
  const auto tell = [&](const TrainingNews& of_unit) {
    if (of_unit.metrics.empty()) return;
    Row row = {{trainer.units().name, static_cast<double>(of_unit.progress.done)}};
    for (const Metric& metric : of_unit.metrics) row.emplace_back(metric.name, metric.value);
    const std::lock_guard lock(mutex);
    news.push_back(std::move(row));
  };
  const auto listen = [&] {
    std::unique_lock lock(mutex);
    const std::deque<Row> rows = std::exchange(news, {});
    lock.unlock();
    for (const Row& row : rows) {
      if (!on_metrics.is_none() && nb::cast<bool>(nb::bool_(on_metrics(dict_of(row))))) stopped = true;
    }
  };
  run_unlocked([&] { finished = trainer.run([&] { return stopped.load(); }, tell); }, listen, [&] { stopped = true; });
  return finished;
}

bool start(const std::string& out, const std::string& options, const std::vector<World>& worlds,
           const nb::object& on_metrics) {
  const TrainOptions parsed = parse_options(nlohmann::ordered_json::parse(options), "train");
  const auto trainer = Trainer::start(parsed, RunDirectory(out), kCpuLearners, worlds);
  return train(*trainer, on_metrics);
}

bool resume(const std::string& run, const nb::object& on_metrics) {
  return train(*Trainer::resume(RunDirectory(run)), on_metrics);
}

}  // namespace

void bind_training(nb::module_& module) {
  module.def("train", &start, nb::arg("out"), nb::arg("options"), nb::arg("worlds"), nb::arg("on_metrics").none());
  module.def("resume", &resume, nb::arg("run"), nb::arg("on_metrics").none());
}

}  // namespace graphdrl::python
