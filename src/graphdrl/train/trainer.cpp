#include "graphdrl/train/trainer.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace graphdrl {

Trainer::Trainer(const TrainOptions& options, RunDirectory run, const Checkpoint* from, const LearnerSource& learners,
                 std::vector<World> worlds)
    : options_(options),
      run_(std::move(run)),
      rng_(options.seed),
      recipe_(make_recipe(options, rng_, from, learners, std::move(worlds))),
      units_(units_of(options)) {
  if (from == nullptr) return;
  progress_ = from->progress();
  if (progress_.done > units_.count) {
    from->fail(fmt::format("the checkpoint is not of this run: it has done more {}s than there are", units_.name));
  }
  recipe_->restore(*from, progress_);
  rng_ = from->rng();
}

void Trainer::check(const TrainOptions& options, const LearnerSource& learners) {
  validate(options);
  Trainer(options, RunDirectory(""), nullptr, learners, {});
}

std::unique_ptr<Trainer> Trainer::start(const TrainOptions& options, const RunDirectory& run,
                                        const LearnerSource& learners, std::vector<World> worlds) {
  validate(options);
  std::unique_ptr<Trainer> trainer(new Trainer(options, run, nullptr, learners, std::move(worlds)));
  run.create();
  write_config(run.config(), options);
  trainer->save();
  return trainer;
}

std::unique_ptr<Trainer> Trainer::resume(const RunDirectory& run, const LearnerSource& learners) {
  const Checkpoint checkpoint = Checkpoint::read(run.checkpoint());
  const TrainOptions options = read_config(run.config());
  checkpoint.require_preset(options.preset);
  return std::unique_ptr<Trainer>(new Trainer(options, run, &checkpoint, learners, {}));
}

bool Trainer::run(const std::function<bool()>& stop, const std::function<void(const TrainingNews&)>& tell) {
  const TrainingProgress before = progress_;
  const auto start = std::chrono::steady_clock::now();
  const auto session_s = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  MetricsFile metrics(run_.metrics(), units_.name, progress_.done);
  EventWriter events(run_.path(), progress_.done + 1);
  bool stopped = false;
  while (!finished() && !stopped && recipe_->run_unit(progress_, stop)) {
    ++progress_.done;
    stopped = stop();
    progress_.elapsed_s = before.elapsed_s + session_s();
    const double rate = static_cast<double>(progress_.samples - before.samples) / std::max(session_s(), 1e-9);
    std::string status = fmt::format("{}  {:.0f} {}/s", recipe_->status(progress_), rate, units_.samples);
    const std::vector<Metric> taken = log(metrics, events);
    tell({.progress = progress_, .status = std::move(status), .metrics = taken});
    if (!finished() && !stopped && progress_.done % options_.checkpoint_every == 0) save();
  }
  progress_.elapsed_s = before.elapsed_s + session_s();
  save();
  return finished();
}

std::vector<Metric> Trainer::log(MetricsFile& metrics, EventWriter& events) {
  std::vector<Metric> taken = recipe_->take_metrics(progress_);
  if (taken.empty()) return taken;
  std::vector<Scalar> all;
  std::vector<Scalar> curves;
  for (const Metric& metric : taken) {
    all.push_back({metric.name, metric.value});
    if (metric.curve && !std::isnan(metric.value)) curves.push_back({metric.name, metric.value});
  }
  metrics.write(progress_.done, all);
  events.write(progress_.done, curves);
  return taken;
}

void Trainer::save() {
  CheckpointWriter checkpoint(options_.preset);
  recipe_->save(checkpoint);
  checkpoint.add(progress_);
  checkpoint.add(rng_);
  checkpoint.write(run_.checkpoint());
  recipe_->write_policy(run_.policy());
}

}  // namespace graphdrl
