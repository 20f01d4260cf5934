// The explorer's memory: the last lessons, sampled uniformly.
#pragma once

#include <vector>

#include "graphdrl/train/checkpoint.h"
#include "graphdrl/train/lessons.h"

namespace graphdrl {

// A ring. Memory grows with what is stored, up to the capacity.
class ExplorerReplay {
 public:
  // REQUIRES: capacity >= 1.
  explicit ExplorerReplay(std::size_t capacity) : capacity_(capacity) {}

  void push(Lesson lesson);

  std::size_t size() const { return lessons_.size(); }
  const Lesson& lesson(std::size_t index) const { return lessons_[index]; }

  // For checkpoints: arrays named replay.*. Worlds are stored as their seeds and drawn again.
  void save(CheckpointWriter& checkpoint) const;
  // Throws Error where a lesson is none that these options draw.
  void restore(const Checkpoint& checkpoint, const LessonOptions& options);

 private:
  std::size_t capacity_;
  std::size_t next_ = 0;  // where the next lesson goes once the ring is full
  std::vector<Lesson> lessons_;
};

}  // namespace graphdrl
