#include "graphdrl/base/parallel.h"

namespace graphdrl {
namespace {
int thread_count = 1;
}

void set_threads(int threads) {
  thread_count = threads;
  omp_set_num_threads(1);
}

int threads() {
  return thread_count;
}

int hardware_threads() {
  return omp_get_num_procs();
}

}  // namespace graphdrl
