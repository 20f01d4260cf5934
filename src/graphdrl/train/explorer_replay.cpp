#include "graphdrl/train/explorer_replay.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace graphdrl {
namespace {

// The arrays of a checkpoint: one entry per lesson, but for `visited` and `label`, whose parts lie end to end.
struct Packed {
  std::vector<std::uint64_t> seed;
  std::vector<std::int64_t> position;
  std::vector<std::int64_t> scope;
  std::vector<double> spendable;
  std::vector<std::uint64_t> visited;
  std::vector<std::int64_t> label_count;
  std::vector<float> label;
};

// Calls field(name, array) for every array.
template <typename AnyPacked, typename Field>
void for_each_array(AnyPacked& packed, const Field& field) {
  field("replay.seed", packed.seed);
  field("replay.position", packed.position);
  field("replay.scope", packed.scope);
  field("replay.spendable", packed.spendable);
  field("replay.visited", packed.visited);
  field("replay.label_count", packed.label_count);
  field("replay.label", packed.label);
}

constexpr const char* kNext = "replay.next";

// Takes the lessons out again, one after the other.
class Unpacker {
 public:
  Unpacker(const Packed& packed, const LessonOptions& options) : packed_(packed), options_(options) {}

  // Whether the next lesson is one that the options draw; it is in `lesson` then.
  bool next(Lesson& lesson) {
    const std::size_t i = index_++;
    // Lessons of one walk share their world.
    std::shared_ptr<const LessonWorld>& at = worlds_[packed_.seed[i]];
    if (!at) at = std::make_shared<LessonWorld>(options_.world_of(packed_.seed[i]), packed_.seed[i]);
    const NodeId nodes = at->world.node_count();
    NodeSet visited(nodes);
    const std::size_t words = visited.words().size();
    const std::int64_t labels = packed_.label_count[i];
    const std::int64_t position = packed_.position[i];
    if (position < 0 || position >= nodes || at->world.is_blocked(static_cast<NodeId>(position)) ||
        !std::isfinite(packed_.spendable[i]) || packed_.scope[i] < 1 || packed_.scope[i] > kExplorerScope ||
        labels < 0 || packed_.visited.size() - visited_at_ < words ||
        packed_.label.size() - label_at_ < static_cast<std::size_t>(labels)) {
      return false;
    }
    const auto first_word = packed_.visited.begin() + static_cast<std::ptrdiff_t>(visited_at_);
    std::copy_n(first_word, words, visited.words().begin());
    const auto first_label = packed_.label.begin() + static_cast<std::ptrdiff_t>(label_at_);
    lesson = {.at = at,
              .visited = std::move(visited),
              .position = static_cast<NodeId>(position),
              .spendable = packed_.spendable[i],
              .scope = static_cast<int>(packed_.scope[i]),
              .shortfall = {first_label, first_label + labels}};
    visited_at_ += words;
    label_at_ += static_cast<std::size_t>(labels);
    ExplorerBatch batch;
    return labels == std::ssize(lesson.append_to(batch, encoder_));
  }

  // Whether nothing is left over.
  bool at_end() const { return visited_at_ == packed_.visited.size() && label_at_ == packed_.label.size(); }

 private:
  const Packed& packed_;
  const LessonOptions& options_;
  std::map<std::uint64_t, std::shared_ptr<const LessonWorld>> worlds_;
  ExplorerEncoder encoder_;
  std::size_t index_ = 0;
  std::size_t visited_at_ = 0;
  std::size_t label_at_ = 0;
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
  Packed packed;
  for (const Lesson& lesson : lessons_) {
    packed.seed.push_back(lesson.at->seed);
    packed.position.push_back(lesson.position);
    packed.scope.push_back(lesson.scope);
    packed.spendable.push_back(lesson.spendable);
    packed.visited.insert(packed.visited.end(), lesson.visited.words().begin(), lesson.visited.words().end());
    packed.label_count.push_back(std::ssize(lesson.shortfall));
    packed.label.insert(packed.label.end(), lesson.shortfall.begin(), lesson.shortfall.end());
  }
  for_each_array(packed, [&](const char* name, auto& values) { checkpoint.add(name, std::move(values)); });
  checkpoint.add(kNext, std::vector<std::int64_t>{static_cast<std::int64_t>(next_)});
}

void ExplorerReplay::restore(const Checkpoint& checkpoint, const LessonOptions& options) {
  const auto require = [&](bool good) {
    if (!good) checkpoint.fail("the lessons remembered in the checkpoint are damaged");
  };
  Packed packed;
  for_each_array(packed,
                 [&]<typename T>(const char* name, std::vector<T>& values) { values = checkpoint.get<T>(name); });
  const std::size_t size = packed.seed.size();
  for (const std::size_t other :
       {packed.position.size(), packed.scope.size(), packed.spendable.size(), packed.label_count.size()}) {
    require(other == size);
  }
  const std::int64_t next = checkpoint.get<std::int64_t>(kNext, {1}).front();
  require(size <= capacity_ && next >= 0 && next <= static_cast<std::int64_t>(size) &&
          next < static_cast<std::int64_t>(capacity_));
  require(std::none_of(packed.label.begin(), packed.label.end(), [](float value) { return std::isinf(value); }));
  next_ = static_cast<std::size_t>(next);
  lessons_.resize(size);
  Unpacker unpacker(packed, options);
  for (Lesson& lesson : lessons_) require(unpacker.next(lesson));
  require(unpacker.at_end());
}

}  // namespace graphdrl
