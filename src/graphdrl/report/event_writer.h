// TensorBoard event files of scalars.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "graphdrl/io/file.h"

namespace graphdrl {

struct Scalar {
  std::string tag;
  double value;
};

// Appends to a new file events.out.tfevents.* in a folder. Every record is written at once, so that TensorBoard can
// follow.
class EventWriter {
 public:
  // `first_step`: TensorBoard drops all steps from this one on that earlier files of the folder hold, so that a resumed
  // run shows no step twice. Throws Error if the file cannot be written.
  EventWriter(const std::filesystem::path& folder, std::int64_t first_step);

  void write(std::int64_t step, std::span<const Scalar> scalars);
  void sync() { file_.sync(); }

 private:
  void write_record(const std::string& record);

  AppendedFile file_;
};

}  // namespace graphdrl
