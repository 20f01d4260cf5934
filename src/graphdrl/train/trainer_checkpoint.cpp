// What a trainer writes into its checkpoints and reads from them.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "graphdrl/base/error.h"
#include "graphdrl/io/ascii_map.h"
#include "graphdrl/train/trainer.h"

namespace graphdrl {
namespace {

constexpr const char* kProgressKey = "progress";
constexpr const char* kWorldsKey = "worlds";

// The one table of TrainingProgress, for saving and restoring.
template <typename Progress, typename Field>
void for_each_progress_field(Progress& progress, const Field& field) {
  field("episode", progress.episode);
  field("steps", progress.steps);
  field("elapsed_s", progress.elapsed_s);
  field("window_episodes", progress.window_episodes);
  field("window_losses", progress.window_losses);
  field("window_loss", progress.window_loss);
  field("window_visited", progress.window_visited);
  field("window_coverage", progress.window_coverage);
  field("window_reward", progress.window_reward);
}

// The worlds themselves go into the checkpoint: a run goes on from anywhere, whatever became of the map files.
std::string pack_worlds(const std::vector<World>& worlds) {
  auto json = nlohmann::ordered_json::array();
  for (const World& world : worlds) json.push_back({{"name", world.name()}, {"map", format_ascii_map(*world.map())}});
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// The text under a key of a checkpoint's metadata, parsed.
nlohmann::json metadata_json(const Safetensors& file, const std::string& key) {
  const auto text = file.metadata().find(key);
  if (text == file.metadata().end()) {
    throw Error({.what = "not a checkpoint", .expected = in_quotes(key) + " in its metadata", .where = file.source()});
  }
  return nlohmann::json::parse(text->second, nullptr, /*allow_exceptions=*/false);
}

}  // namespace

std::vector<World> Trainer::unpack_worlds(const Safetensors& file) {
  const auto fail = [&] { throw Error({.what = "the checkpoint holds no maps", .where = file.source()}); };
  const nlohmann::json json = metadata_json(file, kWorldsKey);
  if (!json.is_array() || json.empty()) fail();
  std::vector<World> worlds;
  for (const auto& item : json) {
    if (!item.is_object() || !item.contains("name") || !item["name"].is_string() || !item.contains("map") ||
        !item["map"].is_string()) {
      fail();
    }
    worlds.emplace_back(item["name"].get<std::string>(),
                        parse_ascii_map(item["map"].get<std::string>(), file.source()));
  }
  return worlds;
}

void Trainer::save() {
  std::vector<TensorView> tensors;
  const LearnerState learner = learner_->state();
  ReplayBuffer::Packed replay;
  append_state(learner, tensors);
  replay_.save(replay, tensors);
  const Rng::State random = rng_.state();
  tensors.emplace_back("random.state", Shape{4}, std::span<const std::uint64_t>(random));
  // An episode under way is stored as its start and its actions, and walked again when restored.
  std::vector<std::int32_t> episode;
  if (in_episode_) {
    episode = {world_, episodes_[world_].walk().front()};
    episode.insert(episode.end(), actions_.begin(), actions_.end());
  }
  tensors.emplace_back("episode", Shape{std::ssize(episode)}, std::span<const std::int32_t>(episode));
  nlohmann::ordered_json json;
  for_each_progress_field(progress_, [&](const char* key, const auto& value) { json[key] = value; });
  write_safetensors(run_.checkpoint(), tensors, {{kProgressKey, json.dump()}, {kWorldsKey, pack_worlds(worlds_)}});
  write_policy_file(run_.policy(), learner.online);
}

void Trainer::restore(const Safetensors& file) {
  const auto fail = [&](const std::string& what) { throw Error({.what = what, .where = file.source()}); };
  const nlohmann::json json = metadata_json(file, kProgressKey);
  for_each_progress_field(progress_, [&](const char* key, auto& value) {
    constexpr bool kWhole = std::is_integral_v<std::remove_reference_t<decltype(value)>>;
    const bool good =
        json.is_object() && json.contains(key) && (kWhole ? json[key].is_number_unsigned() : json[key].is_number());
    if (!good) fail("not a checkpoint: no " + in_quotes(key));
    json[key].get_to(value);
  });
  if (progress_.episode > options_.episodes || progress_.window_episodes > progress_.episode) {
    fail("the checkpoint is not of this run: it has done more episodes than there are");
  }
  learner_->set_state(read_state(file));
  replay_.restore(file, [&](const Transition& t) {
    if (t.world < 0 || t.world >= std::ssize(worlds_)) return false;
    const auto inside = [&](NodeId node) { return node >= 0 && node < worlds_[t.world].graph().node_count(); };
    return inside(t.position) && inside(t.next_position) && t.action >= 0 && t.action < kActionCount;
  });
  const auto random = file.get<std::uint64_t>("random.state", {4});
  Rng::State state{};
  std::copy(random.begin(), random.end(), state.begin());
  if (state == Rng::State{}) fail("the checkpoint holds no random state");
  rng_ = Rng(state);
  restore_episode(file);
}

void Trainer::restore_episode(const Safetensors& file) {
  const auto stored = file.get<std::int32_t>("episode", file.shape_of("episode"));
  if (stored.empty()) return;
  const auto fail = [&] { throw Error({.what = "the episode under way cannot be walked", .where = file.source()}); };
  if (stored.size() < 2 || stored[0] < 0 || stored[0] >= std::ssize(worlds_)) fail();
  begin_episode_at(stored[0], stored[1]);
  Episode& episode = episodes_[world_];
  for (const std::int32_t action : std::span(stored).subspan(2)) {
    if (action < 0 || action >= kActionCount || episode.done()) fail();
    const NodeId from = episode.position();
    const StepResult step = episode.step(action);
    encoders_[world_].update(from, episode.position(), step, features_);
    actions_.push_back(action);
    episode_reward_ += step.reward;
  }
}

}  // namespace graphdrl
