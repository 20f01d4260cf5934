// Small helpers that several tests share.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "graphdrl/base/error.h"
#include "graphdrl/base/random.h"
#include "graphdrl/env/world.h"
#include "graphdrl/io/readers.h"

namespace graphdrl {

inline World grid_world(std::string_view text) {
  return World("test", parse_ascii_map(text, "test"));
}

// A random map with at least one free cell.
inline World random_world(Rng& rng, int rows, int cols, double blocked_share) {
  GridMap map{.rows = rows, .cols = cols, .blocked = {}};
  for (int i = 0; i < rows * cols; ++i) map.blocked.push_back(rng.uniform() < blocked_share);
  map.blocked[rng.below(static_cast<std::uint32_t>(rows * cols))] = false;
  return World("random", map);
}

// A folder of its own for one test, removed at its end.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    const auto* const test = ::testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::temp_directory_path() /
            ("graphdrl_" + std::string(test->test_suite_name()) + "_" + test->name() + "_" + std::to_string(getpid()));
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// The message of the Error that `call` throws; "" where it throws none.
template <typename Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace graphdrl
