#include "graphdrl/nn/gemm.h"

#include <algorithm>
#include <cstdint>

#ifdef __SANITIZE_ADDRESS__
#include <sanitizer/asan_interface.h>
#endif
#ifdef __SANITIZE_THREAD__
// ThreadSanitizer's run-time library has these; its public header does not declare them.
extern "C" void __tsan_read_range(const void* address, unsigned long size);
extern "C" void __tsan_write_range(const void* address, unsigned long size);
#endif

namespace graphdrl {
namespace {

constexpr int kTransposeBlock = 16;

// What a sanitizer of this build is told.
#ifdef __SANITIZE_ADDRESS__
constexpr bool kSanitized = true;
void tell_read(const void* address, std::size_t size) {
  const void* const poisoned = __asan_region_is_poisoned(const_cast<void*>(address), size);
  if (poisoned) static_cast<void>(*static_cast<const volatile char*>(poisoned));  // this read is reported
}
void tell_write(void* address, std::size_t size) {
  tell_read(address, size);
}
#elif defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
void tell_read(const void* address, std::size_t size) {
  __tsan_read_range(address, size);
}
void tell_write(void* address, std::size_t size) {
  __tsan_write_range(address, size);
}
#else
constexpr bool kSanitized = false;
inline void tell_read(const void*, std::size_t) {}
inline void tell_write(void*, std::size_t) {}
#endif

// Tells the sanitizer what a kernel accesses, row by row. GCC builds the kernels without it: with each access
// instrumented, the tests of trainings take several times as long.
template <typename T>
void tell_sanitizer(const GemmTask<T>& task) {
  if constexpr (kSanitized) {
    const int rows_of_a = task.transposed ? task.k : task.m;
    const int columns_of_a = task.transposed ? task.m : task.k;
    for (int row = 0; row < rows_of_a; ++row) tell_read(task.a + row * task.lda, columns_of_a * sizeof(T));
    // All 32 columns, though a kernel may read fewer: no thread may write to a panel in use.
    tell_read(task.panel, static_cast<std::size_t>(task.k) * kPanelColumns * sizeof(T));
    for (int row = 0; row < task.m; ++row) tell_write(task.c + row * task.ldc, task.columns * sizeof(T));
  }
}

using Kernel = void (*)(const GemmTask<float>& task);

Kernel choose_kernel() {
#if defined(GRAPHDRL_X86_KERNELS)
  if (__builtin_cpu_supports("avx512f")) return avx512::multiply;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return avx2::multiply;
#endif
  return plain::multiply;
}

void multiply(const GemmTask<float>& task) {
  static const Kernel kernel = choose_kernel();
  tell_sanitizer(task);
  kernel(task);
}

void multiply(const GemmTask<double>& task) {
  tell_sanitizer(task);
  plain::multiply(task);
}

}  // namespace

template <typename T>
void PackedMatrix<T>::reset(int rows, int columns) {
  rows_ = rows;
  columns_ = columns;
  const std::size_t size = static_cast<std::size_t>(panel_count()) * rows;
  if (columns % kPanelColumns == 0) {  // no padding: set_columns writes every value
    values_.resize(size);
  } else {
    values_.assign(size, PanelRow{});
  }
}

template <typename T>
void PackedMatrix<T>::set_columns(int first, int count, Op op, const T* b, int ldb) {
  for (int column = first; column < first + count;) {
    const int lane = column % kPanelColumns;
    const int width = std::min(kPanelColumns - lane, first + count - column);
    T* const to = panel(column / kPanelColumns) + lane;
    const std::ptrdiff_t at = column - first;
    if (op == Op::kNone) {
      for (int row = 0; row < rows_; ++row) {
        const T* const from = b + static_cast<std::ptrdiff_t>(row) * ldb + at;
        T* const out = to + static_cast<std::ptrdiff_t>(row) * kPanelColumns;
        if (width == kPanelColumns) {
          std::copy_n(from, kPanelColumns, out);  // of a known size: a few vector moves, no call
        } else {
          std::copy_n(from, width, out);
        }
      }
    } else {
      for (int row = 0; row < rows_; row += kTransposeBlock) {
        const int end = std::min(row + kTransposeBlock, rows_);
        for (int j = 0; j < width; ++j) {
          const T* const from = b + (at + j) * ldb;
          for (int i = row; i < end; ++i) to[static_cast<std::ptrdiff_t>(i) * kPanelColumns + j] = from[i];
        }
      }
    }
    column += width;
  }
}

template <typename T>
void PackedMatrix<T>::set_transposed(const PackedMatrix& other) {
  reset(other.columns(), other.rows());
  for (int index = 0; index < other.panel_count(); ++index) {  // 32 rows of this one
    const T* const from = other.panel(index);
    const int first = index * kPanelColumns;
    const int count = std::min(kPanelColumns, rows_ - first);
    for (int block = 0; block < columns_; block += kTransposeBlock) {
      const int end = std::min(block + kTransposeBlock, columns_);
      for (int i = 0; i < count; ++i) {
        T* const to = panel(block / kPanelColumns) + (first + i) * static_cast<std::ptrdiff_t>(kPanelColumns) -
                      block / kPanelColumns * kPanelColumns;
        for (int j = block; j < end; ++j) to[j] = from[static_cast<std::ptrdiff_t>(j) * kPanelColumns + i];
      }
    }
  }
}

template <typename T>
void gemm(Op op_a, int m, int n, int k, const T* a, int lda, const PackedMatrix<T>& b, bool accumulate, T* c, int ldc) {
  for (int column = 0; column < n; column += kPanelColumns) {
    multiply({.transposed = op_a == Op::kTranspose,
              .accumulate = accumulate,
              .m = m,
              .k = k,
              .columns = std::min(kPanelColumns, n - column),
              .a = a,
              .lda = lda,
              .panel = b.panel(column / kPanelColumns),
              .c = c + column,
              .ldc = ldc});
  }
}

template <typename T>
void gemm(int m, const T* a, int lda, const PackedMatrix<T>& b, PackedMatrix<T>& c) {
  c.reset(m, b.columns());
  for (int index = 0; index < b.panel_count(); ++index) {
    multiply({.transposed = false,
              .accumulate = false,
              .m = m,
              .k = b.rows(),
              .columns = kPanelColumns,
              .a = a,
              .lda = lda,
              .panel = b.panel(index),
              .c = c.panel(index),
              .ldc = kPanelColumns});
  }
}

template <typename T>
void gemm(Op op_a, Op op_b, int m, int n, int k, const T* a, int lda, const T* b, int ldb, bool accumulate, T* c,
          int ldc) {
  static thread_local PackedMatrix<T> packed;
  packed.set(k, n, op_b, b, ldb);
  gemm(op_a, m, n, k, a, lda, packed, accumulate, c, ldc);
}

// NOLINTBEGIN(bugprone-macro-parentheses): T is a type.
#define GRAPHDRL_INSTANTIATE(T)                                                                \
  template class PackedMatrix<T>;                                                              \
  template void gemm(Op, int, int, int, const T*, int, const PackedMatrix<T>&, bool, T*, int); \
  template void gemm(int, const T*, int, const PackedMatrix<T>&, PackedMatrix<T>&);            \
  template void gemm(Op, Op, int, int, int, const T*, int, const T*, int, bool, T*, int);
// NOLINTEND(bugprone-macro-parentheses)
GRAPHDRL_INSTANTIATE(float)
GRAPHDRL_INSTANTIATE(double)
#undef GRAPHDRL_INSTANTIATE

}  // namespace graphdrl
