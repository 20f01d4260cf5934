// TensorBoard event files of scalars.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>

namespace graphdrl {

struct Scalar {
  std::string tag;
  double value;
};

// Appends to a new file events.out.tfevents.* in a folder. Every record is flushed, so that TensorBoard can follow.
class EventWriter {
 public:
  // `first_step`: TensorBoard drops all steps from this one on that earlier files of the folder hold, so that a resumed
  // run shows no step twice. Throws Error if the file cannot be written.
  EventWriter(const std::filesystem::path& folder, std::int64_t first_step);

  void write(std::int64_t step, std::span<const Scalar> scalars);

 private:
  void write_record(const std::string& record);

  std::filesystem::path path_;
  std::ofstream file_;
};

}  // namespace graphdrl
