// Lessons as plain arrays: for checkpoints, or to draw them on one machine and learn from them on another.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "graphdrl/train/lessons.h"

namespace graphdrl {

// One entry per lesson, but for `visited` and `label`, whose parts lie end to end.
struct LessonArrays {
  std::vector<std::uint64_t> seed;  // of the world, which is drawn from it again
  std::vector<std::int64_t> position;
  std::vector<std::int64_t> scope;
  std::vector<double> spendable;
  std::vector<std::uint64_t> visited;  // the words of the sets
  std::vector<std::int64_t> label_count;
  std::vector<float> label;

  void add(const Lesson& lesson);

  // Nothing where a lesson is none that these options draw.
  std::optional<std::vector<Lesson>> lessons(const LessonOptions& options) const;

  // Calls field(name, array) for every array of a LessonArrays, const or not.
  template <typename Arrays, typename Field>
  static void for_each(Arrays& arrays, const Field& field) {
    field("seed", arrays.seed);
    field("position", arrays.position);
    field("scope", arrays.scope);
    field("spendable", arrays.spendable);
    field("visited", arrays.visited);
    field("label_count", arrays.label_count);
    field("label", arrays.label);
  }
};

}  // namespace graphdrl
