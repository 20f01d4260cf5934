// Compiled once per instruction set, with GRAPHDRL_ISA its name; includes nothing whose inline code could leak from one
// of those objects into another.
#include "graphdrl/nn/gemm_kernel.h"

namespace graphdrl::GRAPHDRL_ISA {
namespace {

// The tile of c that stays in registers: kTileRows × kTileVectors vectors, with room left for the panel's.
#if defined(__AVX512F__)
constexpr int kVectorBytes = 64;
constexpr int kTileRows = 12;
#elif defined(__AVX2__)
constexpr int kVectorBytes = 32;
constexpr int kTileRows = 6;
#else
constexpr int kVectorBytes = 16;
constexpr int kTileRows = 6;
#endif
constexpr int kTileVectors = 2;

template <typename T>
struct Vectors {
  typedef T Aligned __attribute__((vector_size(kVectorBytes)));
  typedef T Loose __attribute__((vector_size(kVectorBytes), aligned(alignof(T)), may_alias));
  static constexpr int kLanes = kVectorBytes / static_cast<int>(sizeof(T));
};

// Rows [0, kRows) of c.
template <typename T, int kRows, bool kTransposed>
void multiply_tile(const GemmTask<T>& task, const T* a, T* c) {
  using Vector = typename Vectors<T>::Aligned;
  constexpr int kLanes = Vectors<T>::kLanes;
  constexpr int kTripleCount = (kRows + 2) / 3;  // row 3 g + i is reached from pointer g: few registers of addresses
  for (int part = 0; part < task.columns; part += kTileVectors * kLanes) {
    Vector sum[kRows][kTileVectors];
#pragma GCC unroll 16
    for (int i = 0; i < kRows; ++i) {
#pragma GCC unroll 2
      for (int v = 0; v < kTileVectors; ++v) sum[i][v] = Vector{};
    }
    const T* b = task.panel + part;
    const T* triples[kTripleCount];
    for (int g = 0; g < kTripleCount; ++g) triples[g] = kTransposed ? a + 3 * g : a + 3 * g * task.lda;
    const std::ptrdiff_t row = kTransposed ? 1 : task.lda;
    const std::ptrdiff_t next = kTransposed ? task.lda : 1;
    for (int p = 0; p < task.k; ++p, b += kPanelColumns) {
      Vector of_b[kTileVectors];
#pragma GCC unroll 2
      for (int v = 0; v < kTileVectors; ++v) of_b[v] = *reinterpret_cast<const Vector*>(b + v * kLanes);
#pragma GCC unroll 16
      for (int i = 0; i < kRows; ++i) {
        const T of_a = triples[i / 3][i % 3 * row];
#pragma GCC unroll 2
        for (int v = 0; v < kTileVectors; ++v) sum[i][v] += of_a * of_b[v];
      }
#pragma GCC unroll 16
      for (int g = 0; g < kTripleCount; ++g) triples[g] += next;
    }
    if (task.columns - part >= kTileVectors * kLanes) {
#pragma GCC unroll 16
      for (int i = 0; i < kRows; ++i) {
#pragma GCC unroll 2
        for (int v = 0; v < kTileVectors; ++v) {
          auto* const out = reinterpret_cast<typename Vectors<T>::Loose*>(c + i * task.ldc + part + v * kLanes);
          *out = task.accumulate ? *out + sum[i][v] : sum[i][v];
        }
      }
    } else {
      for (int i = 0; i < kRows; ++i) {
        const T* const from = reinterpret_cast<const T*>(sum[i]);
        T* const out = c + i * task.ldc + part;
        for (int j = 0; j < task.columns - part; ++j) out[j] = task.accumulate ? out[j] + from[j] : from[j];
      }
    }
  }
}

template <typename T, int kRows, bool kTransposed>
void multiply_rows(int rows, const GemmTask<T>& task, const T* a, T* c) {
  if (rows == kRows) return multiply_tile<T, kRows, kTransposed>(task, a, c);
  if constexpr (kRows > 1) multiply_rows<T, kRows - 1, kTransposed>(rows, task, a, c);
}

// Cuts the rows into tiles as equal as can be: short ones leave the multipliers idle.
template <typename T, bool kTransposed>
void multiply_all(const GemmTask<T>& task) {
  for (int tiles = (task.m + kTileRows - 1) / kTileRows, row = 0; tiles > 0; --tiles) {
    const int rows = (task.m - row + tiles - 1) / tiles;
    multiply_rows<T, kTileRows, kTransposed>(rows, task, task.a + row * (kTransposed ? 1 : task.lda),
                                             task.c + row * task.ldc);
    row += rows;
  }
}

template <typename T>
void multiply_any(const GemmTask<T>& task) {
  task.transposed ? multiply_all<T, true>(task) : multiply_all<T, false>(task);
}

}  // namespace

void multiply(const GemmTask<float>& task) {
  multiply_any(task);
}

#if defined(GRAPHDRL_GEMM_DOUBLE)
void multiply(const GemmTask<double>& task) {
  multiply_any(task);
}
#endif

}  // namespace graphdrl::GRAPHDRL_ISA
