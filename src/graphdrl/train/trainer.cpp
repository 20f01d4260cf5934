#include "graphdrl/train/trainer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "graphdrl/base/clock.h"
#include "graphdrl/base/note.h"
#include "graphdrl/io/checksum.h"
#include "graphdrl/io/file.h"

namespace graphdrl {
namespace {

constexpr const char* kOptionsKey = "options";
constexpr const char* kMetrics = "metrics";
constexpr const char* kRollbacksKey = "rollbacks";
constexpr std::int64_t kMostRollbacks = 3;

void say(const RunDirectory& run, const std::string& what) {
  note(run.path().string() + ": " + what);
}

std::optional<TrainOptions> config_of(const RunDirectory& run) {
  try {
    return read_config(run.config());
  } catch (const MachineError&) {
    throw;
  } catch (const Error&) {
    return std::nullopt;
  }
}

// Whether a file holds this; may_go_on: and maybe more behind it.
bool is_as_meant(const std::filesystem::path& path, const std::string& content, bool may_go_on = false) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return false;
  const std::string found = read_file(path);
  return may_go_on ? found.starts_with(content) : found == content;
}

// The checkpoint, or the one before it. Throws the Error of the first if none is whole.
std::optional<Checkpoint> newest_checkpoint(const RunDirectory& run) {
  std::exception_ptr failure;
  std::error_code error;
  for (const auto& file : {run.checkpoint(), run.previous_checkpoint()}) {
    if (!std::filesystem::exists(file, error)) continue;
    try {
      return Checkpoint::read(file);
    } catch (const MachineError&) {
      throw;
    } catch (const Error&) {
      if (!failure) failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
  return std::nullopt;
}

}  // namespace

TrainOptions Trainer::options_of(const RunDirectory& run) {
  const std::optional<Checkpoint> from = newest_checkpoint(run);
  if (from && from->holds_options()) return parse_options(from->json(kOptionsKey), from->source());
  return config_of(run).value_or(TrainOptions{});
}

Trainer::Trainer(const TrainOptions& options, RunDirectory run, const Checkpoint* from, const LearnerSource& learners,
                 std::vector<World> worlds, Ranks& ranks)
    : options_(options),
      run_(std::move(run)),
      learners_(learners),
      ranks_(ranks),
      rng_(options.seed),
      units_(units_of(options)) {
  if (from != nullptr) {
    restore(*from);
  } else {
    recipe_ = make_recipe(options_, rng_, nullptr, learners_, std::move(worlds), ranks_);
  }
}

void Trainer::restore(const Checkpoint& from) {
  progress_ = from.progress();
  if (progress_.done > units_.count) {
    from.fail(fmt::format("the checkpoint is not of this run: it has done more {}s than there are", units_.name));
  }
  if (from.has_json(kRollbacksKey) && rollbacks_ == 0) {
    from.read_number(from.json(kRollbacksKey), "count", rollbacks_);
  }
  TrainOptions slower = options_;
  slower.learning_rate = std::ldexp(options_.learning_rate, -static_cast<int>(rollbacks_));
  recipe_ = make_recipe(slower, rng_, &from, learners_, {}, ranks_);
  recipe_->restore(from, progress_);
  rng_ = from.rng();
  if (!from.holds_options()) return;
  const auto lines = from.get<char>(kMetrics);
  metrics_.assign(lines.begin(), lines.end());
}

void Trainer::check(const TrainOptions& options, const LearnerSource& learners) {
  validate(options);
  Trainer(options, RunDirectory(""), nullptr, learners, {}, one_rank());
}

std::unique_ptr<Trainer> Trainer::start(const TrainOptions& options, const RunDirectory& run,
                                        const LearnerSource& learners, std::vector<World> worlds, Ranks& ranks) {
  validate(options);
  std::unique_ptr<Trainer> trainer(new Trainer(options, run, nullptr, learners, std::move(worlds), ranks));
  ranks.on_first([&] {
    run.require_new();
    prepare_folder(run.path());
    trainer->lock_ = std::make_unique<RunLock>(run);
    run.require_new();
  });
  trainer->save();
  return trainer;
}

std::unique_ptr<Trainer> Trainer::resume(const RunDirectory& run, const LearnerSource& learners, Ranks& ranks) {
  std::unique_ptr<RunLock> lock;
  ranks.on_first([&] {
    if (!run.holds_a_run()) throw Error({.what = "there is no run to go on with", .where = run.path().string()});
    learners.prepare(options_of(run).device);
    lock = std::make_unique<RunLock>(run);
  });
  const RunState state = state_of(run);
  const std::optional<Checkpoint> from = newest_checkpoint(run);
  if (!ranks.alone())
    ranks.require_same("files in " + run.path().string(), from ? checksum({read_file(from->source())}) : "");
  const auto config = config_of(run);
  if (!from) {
    const bool alone =
        !std::filesystem::exists(run.policy()) && !std::filesystem::exists(run.metrics()) && !state.record;
    if (!config || !alone) {
      throw Error({.what = "the run cannot be gone on with: it has no checkpoint", .where = run.path().string()});
    }
    if (ranks.is_first()) say(run, "there is no checkpoint: the run begins anew");
  }
  const TrainOptions options = !from                   ? *config
                               : from->holds_options() ? parse_options(from->json(kOptionsKey), from->source())
                                                       : read_config(run.config());
  if (from) from->require_preset(options.preset);
  std::unique_ptr<Trainer> trainer(new Trainer(options, run, from ? &*from : nullptr, learners, {}, ranks));
  trainer->lock_ = std::move(lock);
  trainer->saved_ = trainer->progress_;
  if (!from) {
    trainer->save();
  } else if (state.finished()) {
    trainer->is_whole_ = true;
  } else if (ranks.is_first()) {
    trainer->mend(state, *from);
  }
  return trainer;
}

// Says what is missing or damaged, and takes the place of it. What a kill in the middle of a save leaves is no fault.
void Trainer::mend(const RunState& state, const Checkpoint& from) {
  keeps_checkpoint_ = from.source() == run_.checkpoint().string();
  if (!keeps_checkpoint_) {
    say(run_, fmt::format("{} is missing or damaged: going on from the one before it, of {} {}",
                          run_.checkpoint().filename().string(), units_.name, progress_.done));
  }
  const std::string counter = units_.name;
  if (!from.holds_options()) {
    metrics_ = metrics_until(run_.metrics(), counter, progress_.done);
    return;
  }
  if (!is_as_meant(run_.config(), config_text(options_))) {
    say(run_, run_.config().filename().string() + " is missing or not what the run was begun with: written anew");
  }
  if (!metrics_.empty() && !is_as_meant(run_.metrics(), metrics_, /*may_go_on=*/true)) {
    say(run_, run_.metrics().filename().string() + " is missing or damaged: written anew");
  }
  if (progress_.samples == 0) return;
  if (!state.record) {
    say(run_, state.faults.front() + ": written anew");
  } else if (state.record->progress.samples != progress_.samples) {
    return;
  }
  const bool has_policy = state.record ? state.is_whole(run_.policy()) : std::filesystem::exists(run_.policy());
  if (!has_policy) say(run_, run_.policy().filename().string() + " is missing or damaged: written anew");
}

bool Trainer::run(const std::function<bool()>& stop, const std::function<void(const TrainingNews&)>& tell) {
  if (is_whole_) return true;
  const auto refuse = [&](const std::string& what) {
    throw MachineError({.what = fmt::format("{}; saved up to {} {}; to go on: graphdrl train --resume {}", what,
                                            units_.name, saved_.done, run_.path().string())});
  };
  std::optional<NotFinite> failure;
  while (true) {
    try {
      if (failure) go_back(*failure);
      failure.reset();
      return train(stop, tell);
    } catch (const NotFinite& found) {
      if (failure) throw;  // it cannot go back
      failure = found;
    } catch (const MachineError& error) {
      refuse(error.what());
    } catch (const std::bad_alloc&) {
      refuse("out of memory");
    }
  }
}

// To the last checkpoint, with half the learning rate; the checkpoint says so from then on.
void Trainer::go_back(const NotFinite& failure) {
  const std::string checkpoint = fmt::format("{}, of {} {}", run_.checkpoint().string(), units_.name, saved_.done);
  const std::string tensor = recipe_->not_finite();
  const std::string what =
      fmt::format("{}; {}; the last good checkpoint: {}", failure.what(),
                  tensor.empty() ? "all weights are finite" : tensor + " is not finite", checkpoint);
  if (options_.on_nan != kRollback) {
    throw NotFinite({.what = what, .expected = "a smaller --learning-rate, or --on-nan rollback"});
  }
  if (rollbacks_ == kMostRollbacks) {
    throw NotFinite(
        {.what = what, .expected = fmt::format("a smaller --learning-rate: it was halved {} times", rollbacks_)});
  }
  ++rollbacks_;
  if (ranks_.is_first()) {
    say(run_, fmt::format("{}; going on from there with the learning rate halved, {} of {} times", what, rollbacks_,
                          kMostRollbacks));
  }
  const Checkpoint from = newest_checkpoint(run_).value();
  keeps_checkpoint_ = from.source() == run_.checkpoint().string();
  restore(from);
  ranks_.any(false);  // all have read before the first one writes
  metrics_file_.reset();
  save();
}

bool Trainer::train(const std::function<bool()>& stop, const std::function<void(const TrainingNews&)>& tell) {
  const TrainingProgress before = progress_;
  const Stopwatch session;
  const auto must_stop = [&] {
    if (lock_) lock_->beat();
    return stop();
  };
  ranks_.on_first([&] {
    metrics_file_ = std::make_unique<MetricsFile>(run_.metrics(), units_.name, metrics_);
    events_ = std::make_unique<EventWriter>(run_.path(), progress_.done + 1);
  });
  bool stopped = false;
  while (!finished() && !stopped && recipe_->run_unit(progress_, must_stop)) {
    ++progress_.done;
    if (options_.device == "cpu") require_finite();  // a device would wait
    stopped = ranks_.any(must_stop());
    progress_.elapsed_s = before.elapsed_s + session.seconds();
    const double rate = static_cast<double>(progress_.samples - before.samples) / std::max(session.seconds(), 1e-9);
    std::string status = fmt::format("{}  {:.0f} {}/s", recipe_->status(progress_), rate, units_.samples);
    const std::vector<Metric> taken = log();
    tell({.progress = progress_, .status = std::move(status), .metrics = taken});
    if (!finished() && !stopped && progress_.done % options_.checkpoint_every == 0) save();
  }
  progress_.elapsed_s = before.elapsed_s + session.seconds();
  save();
  return finished();
}

std::vector<Metric> Trainer::log() {
  std::vector<Metric> taken = recipe_->take_metrics(progress_);
  if (taken.empty() || !ranks_.is_first()) return taken;
  std::vector<Scalar> all;
  std::vector<Scalar> curves;
  for (const Metric& metric : taken) {
    all.push_back({metric.name, metric.value});
    if (metric.curve && !std::isnan(metric.value)) curves.push_back({metric.name, metric.value});
  }
  metrics_file_->write(progress_.done, all);
  events_->write(progress_.done, curves);
  return taken;
}

void Trainer::require_finite() const {
  if (recipe_->not_finite().empty()) return;
  throw NotFinite({.what = fmt::format("a weight is not finite after {} {}, {} {}", units_.name, progress_.done,
                                       progress_.samples, units_.samples)});
}

// Each file is on the disk before the next one: what the record names is there. A kill between two of them leaves a
// checkpoint that is newer than the record, from which the rest is written again.
void Trainer::save() {
  require_finite();
  ranks_.on_first([&] { write_files(); });
  saved_ = progress_;
}

void Trainer::write_files() {
  lock_->require_held();
  // What others did to these files in the meantime is undone.
  const std::string config = config_text(options_);
  if (!is_as_meant(run_.config(), config)) write_file(run_.config(), config);
  if (metrics_file_) {
    metrics_ = metrics_file_->lines();
    if (!is_as_meant(run_.metrics(), metrics_)) {
      metrics_file_ = std::make_unique<MetricsFile>(run_.metrics(), units_.name, metrics_);
    }
    metrics_file_->sync();
    events_->sync();
  }
  RunRecord record{.finished = finished(), .progress = progress_, .files = {}};
  CheckpointWriter writer(options_.preset);
  recipe_->save(writer);
  writer.add(progress_);
  writer.add(rng_);
  writer.add_json(kOptionsKey, config_json(options_));
  if (rollbacks_ > 0) writer.add_json(kRollbacksKey, {{"count", rollbacks_}});
  writer.add(kMetrics, std::vector<char>(metrics_.begin(), metrics_.end()));
  const std::string checkpoint = writer.content();
  if (keeps_checkpoint_) {
    write_file_and_keep(run_.checkpoint(), checkpoint, run_.previous_checkpoint());
  } else {
    write_file(run_.checkpoint(), checkpoint);
  }
  keeps_checkpoint_ = true;
  recipe_->write_policy(run_.policy());
  record.add(run_.checkpoint(), checkpoint);
  record.add(run_.policy(), read_file(run_.policy()));
  record.add(run_.config(), config);
  if (metrics_file_) record.add(run_.metrics(), metrics_);
  write_record(run_, record);
}

}  // namespace graphdrl
