#include "graphdrl/train/explorer_replay.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace graphdrl {
namespace {

constexpr const char* kNext = "replay.next";

// Lessons as a checkpoint holds them: one entry each, but for `visited` and `label`, whose parts lie end to end.
struct LessonArrays {
  std::vector<std::uint64_t> seed;  // of the world
  std::vector<std::int64_t> position;
  std::vector<std::int64_t> scope;
  std::vector<double> spendable;
  std::vector<std::uint64_t> visited;  // the words of the sets
  std::vector<std::int64_t> label_count;
  std::vector<float> label;

  template <typename Field>
  void for_each(const Field& field) {
    field("replay.seed", seed);
    field("replay.position", position);
    field("replay.scope", scope);
    field("replay.spendable", spendable);
    field("replay.visited", visited);
    field("replay.label_count", label_count);
    field("replay.label", label);
  }
};

}  // namespace

void ExplorerReplay::push(Lesson lesson) {
  if (lessons_.size() < capacity_) {
    lessons_.push_back(std::move(lesson));
    return;
  }
  lessons_[next_] = std::move(lesson);
  next_ = (next_ + 1) % capacity_;
}

void ExplorerReplay::save(CheckpointWriter& checkpoint) const {
  LessonArrays arrays;
  for (const Lesson& lesson : lessons_) {
    arrays.seed.push_back(lesson.at->seed);
    arrays.position.push_back(lesson.position);
    arrays.scope.push_back(lesson.scope);
    arrays.spendable.push_back(lesson.spendable);
    arrays.visited.insert(arrays.visited.end(), lesson.visited.words().begin(), lesson.visited.words().end());
    arrays.label_count.push_back(std::ssize(lesson.shortfall));
    arrays.label.insert(arrays.label.end(), lesson.shortfall.begin(), lesson.shortfall.end());
  }
  arrays.for_each([&](const char* name, auto& values) { checkpoint.add(name, std::move(values)); });
  checkpoint.add(kNext, std::vector<std::int64_t>{static_cast<std::int64_t>(next_)});
}

void ExplorerReplay::restore(const Checkpoint& checkpoint, const LessonOptions& options) {
  const auto require = [&](bool good) {
    if (!good) checkpoint.fail("the lessons remembered in the checkpoint are damaged");
  };
  LessonArrays arrays;
  arrays.for_each([&]<typename T>(const char* name, std::vector<T>& values) { values = checkpoint.get<T>(name); });
  const std::size_t size = arrays.seed.size();
  const std::int64_t next = checkpoint.get<std::int64_t>(kNext, {1}).front();
  require(size <= capacity_ && next >= 0 && next <= std::ssize(arrays.seed) &&
          next < static_cast<std::int64_t>(capacity_));
  for (const std::size_t entries :
       {arrays.position.size(), arrays.scope.size(), arrays.spendable.size(), arrays.label_count.size()}) {
    require(entries == size);
  }
  require(std::ranges::none_of(arrays.label, [](float value) { return std::isinf(value); }));

  std::map<std::uint64_t, std::shared_ptr<const LessonWorld>> worlds;  // lessons of one walk share theirs
  std::span<const std::uint64_t> words = arrays.visited;               // of the lessons to come
  std::span<const float> labels = arrays.label;
  std::vector<Lesson> lessons;
  ExplorerScratch scratch;
  ExplorerBatch batch;
  for (std::size_t i = 0; i < size; ++i) {
    std::shared_ptr<const LessonWorld>& at = worlds[arrays.seed[i]];
    if (!at) at = std::make_shared<LessonWorld>(options.world_of(arrays.seed[i]), arrays.seed[i]);
    const World& world = at->world;
    NodeSet visited(world.node_count());
    const std::size_t own_words = visited.words().size();
    const std::int64_t position = arrays.position[i];
    const std::int64_t own_labels = arrays.label_count[i];
    require(position >= 0 && position < world.node_count() && !world.is_blocked(static_cast<NodeId>(position)));
    require(std::isfinite(arrays.spendable[i]) && arrays.scope[i] >= 1 && arrays.scope[i] <= kExplorerScope);
    require(own_words <= words.size() && own_labels >= 0 && own_labels <= std::ssize(labels));
    std::copy_n(words.begin(), own_words, visited.words().begin());
    lessons.push_back({.at = at,
                       .visited = std::move(visited),
                       .position = static_cast<NodeId>(position),
                       .spendable = arrays.spendable[i],
                       .scope = static_cast<int>(arrays.scope[i]),
                       .shortfall = {labels.begin(), labels.begin() + own_labels}});
    batch.clear();
    require(std::ssize(lessons.back().append_to(batch, scratch)) == own_labels);
    words = words.subspan(own_words);
    labels = labels.subspan(static_cast<std::size_t>(own_labels));
  }
  require(words.empty() && labels.empty());
  lessons_ = std::move(lessons);
  next_ = static_cast<std::size_t>(next);
}

}  // namespace graphdrl
