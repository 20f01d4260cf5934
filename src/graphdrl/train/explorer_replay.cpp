#include "graphdrl/train/explorer_replay.h"

#include "graphdrl/train/lesson_arrays.h"

namespace graphdrl {
namespace {

constexpr const char* kPrefix = "replay.";
constexpr const char* kNext = "replay.next";

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
  for (const Lesson& lesson : lessons_) arrays.add(lesson);
  LessonArrays::for_each(
      arrays, [&](const char* name, auto& values) { checkpoint.add(kPrefix + std::string(name), std::move(values)); });
  checkpoint.add(kNext, std::vector<std::int64_t>{static_cast<std::int64_t>(next_)});
}

void ExplorerReplay::restore(const Checkpoint& checkpoint, const LessonOptions& options) {
  const auto require = [&](bool good) {
    if (!good) checkpoint.fail("the lessons remembered in the checkpoint are damaged");
  };
  LessonArrays arrays;
  LessonArrays::for_each(arrays, [&]<typename T>(const char* name, std::vector<T>& values) {
    values = checkpoint.get<T>(kPrefix + std::string(name));
  });
  const auto size = std::ssize(arrays.seed);
  const auto capacity = static_cast<std::int64_t>(capacity_);
  const std::int64_t next = checkpoint.get<std::int64_t>(kNext, {1}).front();
  require(size <= capacity && next >= 0 && next <= size && next < capacity);
  std::optional<std::vector<Lesson>> lessons = arrays.lessons(options);
  require(lessons.has_value());
  lessons_ = std::move(*lessons);
  next_ = static_cast<std::size_t>(next);
}

}  // namespace graphdrl
