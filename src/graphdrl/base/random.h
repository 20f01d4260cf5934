// Random numbers whose whole state is four words, so that a checkpoint can hold it.
#pragma once

#include <array>
#include <cstdint>

namespace graphdrl {

// xoshiro256** [Blackman and Vigna 2018], seeded by splitmix64. The same seed gives the same numbers everywhere.
class Rng {
 public:
  using State = std::array<std::uint64_t, 4>;

  explicit Rng(std::uint64_t seed);
  // REQUIRES: state is not all 0, from which nothing else would follow.
  explicit Rng(const State& state) : state_(state) {}

  std::uint64_t next();
  std::uint32_t below(std::uint32_t bound);  // uniform in [0, bound). REQUIRES: bound > 0.
  int index(int count) { return static_cast<int>(below(static_cast<std::uint32_t>(count))); }  // the same of an int
  double uniform();  // uniform in [0, 1), 53 bits

  const State& state() const { return state_; }

 private:
  State state_;
};

// A seed for one purpose of many that share a user's seed; its numbers have nothing to do with those of any other.
std::uint64_t derive_seed(std::uint64_t seed, std::uint64_t purpose, std::uint64_t index = 0);

}  // namespace graphdrl
