// What ranks take to tell each other something: mpirun -n 2 ranks_benchmark. The model of docs/cluster.md stands on it.
#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "graphdrl/base/clock.h"
#include "graphdrl/mpi/mpi_ranks.h"

namespace {

// Microseconds, the median of many.
template <typename Call>
double median_us(int times, const Call& call) {
  std::vector<double> us;
  for (int i = 0; i < times; ++i) {
    const graphdrl::Stopwatch watch;
    call();
    us.push_back(watch.seconds() * 1e6);
  }
  std::ranges::nth_element(us, us.begin() + times / 2);
  return us[times / 2];
}

}  // namespace

int main(int argc, char** argv) {
  graphdrl::MpiRanks ranks(argc, argv);
  const double any = median_us(2000, [&] { ranks.any(false); });
  if (ranks.is_first()) fmt::print("{} ranks\nany: {:.1f} us\n", ranks.size(), any);
  for (const std::size_t bytes : std::initializer_list<std::size_t>{1'000, 10'000, 100'000, 1'000'000, 10'000'000}) {
    const std::string own(bytes, 'x');
    const double us = median_us(bytes < 1'000'000 ? 500 : 50, [&] { ranks.gather(own); });
    if (ranks.is_first()) fmt::print("gather of {} bytes each: {:.1f} us\n", bytes, us);
  }
  ranks.settle({});
}
