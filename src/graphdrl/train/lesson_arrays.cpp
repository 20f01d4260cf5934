#include "graphdrl/train/lesson_arrays.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace graphdrl {

void LessonArrays::add(const Lesson& lesson) {
  seed.push_back(lesson.at->seed);
  position.push_back(lesson.position);
  scope.push_back(lesson.scope);
  spendable.push_back(lesson.spendable);
  visited.insert(visited.end(), lesson.visited.words().begin(), lesson.visited.words().end());
  label_count.push_back(std::ssize(lesson.shortfall));
  label.insert(label.end(), lesson.shortfall.begin(), lesson.shortfall.end());
}

std::optional<std::vector<Lesson>> LessonArrays::lessons(const LessonOptions& options) const {
  for (const std::size_t size : {position.size(), scope.size(), spendable.size(), label_count.size()}) {
    if (size != seed.size()) return std::nullopt;
  }
  if (std::any_of(label.begin(), label.end(), [](float value) { return std::isinf(value); })) return std::nullopt;
  std::map<std::uint64_t, std::shared_ptr<const LessonWorld>> worlds;  // lessons of one walk share theirs
  std::span<const std::uint64_t> words = visited;                      // of the lessons to come
  std::span<const float> labels = label;
  std::vector<Lesson> lessons;
  ExplorerScratch scratch;
  ExplorerBatch batch;
  for (std::size_t i = 0; i < seed.size(); ++i) {
    std::shared_ptr<const LessonWorld>& at = worlds[seed[i]];
    if (!at) at = std::make_shared<LessonWorld>(options.world_of(seed[i]), seed[i]);
    const World& world = at->world;
    NodeSet set(world.node_count());
    const std::size_t set_words = set.words().size();
    if (position[i] < 0 || position[i] >= world.node_count() || world.is_blocked(static_cast<NodeId>(position[i])) ||
        !std::isfinite(spendable[i]) || scope[i] < 1 || scope[i] > kExplorerScope || words.size() < set_words ||
        label_count[i] < 0 || std::ssize(labels) < label_count[i]) {
      return std::nullopt;
    }
    std::copy_n(words.begin(), set_words, set.words().begin());
    const auto own = labels.first(static_cast<std::size_t>(label_count[i]));
    lessons.push_back({.at = at,
                       .visited = std::move(set),
                       .position = static_cast<NodeId>(position[i]),
                       .spendable = spendable[i],
                       .scope = static_cast<int>(scope[i]),
                       .shortfall = {own.begin(), own.end()}});
    batch.clear();
    if (std::ssize(lessons.back().append_to(batch, scratch)) != label_count[i]) return std::nullopt;
    words = words.subspan(set_words);
    labels = labels.subspan(own.size());
  }
  if (!words.empty() || !labels.empty()) return std::nullopt;
  return lessons;
}

}  // namespace graphdrl
