// The innermost loop of the matrix products, compiled once per instruction set (gemm_kernel.cpp) and chosen at run time
// (gemm.cpp).
#pragma once

#include <cstddef>

namespace graphdrl {

inline constexpr int kPanelColumns = 32;

// c = a · panel, or c += a · panel. a: [m, k] with rows `lda` apart, or [k, m] where `transposed`; panel: [k, 32],
// aligned to 64 bytes; c: [m, columns] with rows `ldc` apart, columns <= 32.
template <typename T>
struct GemmTask {
  bool transposed;
  bool accumulate;
  int m;
  int k;
  int columns;
  const T* a;
  std::ptrdiff_t lda;
  const T* panel;
  T* c;
  std::ptrdiff_t ldc;
};

// Each value of c is one sum over k in order, with fused multiplication and addition in `avx2` and `avx512`, whose
// results are therefore the same.
namespace plain {
void multiply(const GemmTask<float>& task);
void multiply(const GemmTask<double>& task);
}  // namespace plain
namespace avx2 {
void multiply(const GemmTask<float>& task);
}
namespace avx512 {
void multiply(const GemmTask<float>& task);
}

}  // namespace graphdrl
