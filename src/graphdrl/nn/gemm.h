// Row-major matrix products C = op(A) B, or C += op(A) B, on kernels of our own: a network multiplies by the same
// weights again and again, so they are packed once, and its shapes are too small for a general library to do well
// (docs/performance.md).
#pragma once

#include <vector>

#include "graphdrl/nn/gemm_kernel.h"

namespace graphdrl {

enum class Op { kNone, kTranspose };

// A right operand [k, n], laid out as the kernels read it: panels of 32 columns, padded with zeros. Memory grows and is
// then reused. T is float or double.
template <typename T>
class PackedMatrix {
 public:
  int rows() const { return rows_; }        // k
  int columns() const { return columns_; }  // n

  // A new size; the values are unspecified until set_columns() gives them.
  void reset(int rows, int columns);

  // Columns [first, first + count) from op(b): [rows, count], rows of b `ldb` apart.
  // REQUIRES: first + count <= columns().
  void set_columns(int first, int count, Op op, const T* b, int ldb);

  // All of it.
  void set(int rows, int columns, Op op, const T* b, int ldb) {
    reset(rows, columns);
    set_columns(0, columns, op, b, ldb);
  }

  void set_transposed(const PackedMatrix& other);

  int panel_count() const { return (columns_ + kPanelColumns - 1) / kPanelColumns; }
  T* panel(int index) { return values_.data()[static_cast<std::size_t>(index) * rows_].values; }
  const T* panel(int index) const { return values_.data()[static_cast<std::size_t>(index) * rows_].values; }

 private:
  struct alignas(64) PanelRow {
    T values[kPanelColumns];
  };
  int rows_ = 0;
  int columns_ = 0;
  std::vector<PanelRow> values_;
};

// c [m, n] = op(a) b, or c += op(a) b, with the first k rows and the first n columns of b. a: [m, k] with rows `lda`
// apart, or [k, m] transposed.
template <typename T>
void gemm(Op op_a, int m, int n, int k, const T* a, int lda, const PackedMatrix<T>& b, bool accumulate, T* c, int ldc);

// c = a b, laid out as a right operand itself. a: [m, k].
template <typename T>
void gemm(int m, const T* a, int lda, const PackedMatrix<T>& b, PackedMatrix<T>& c);

// c [m, n] = op(a) op(b), or c += op(a) op(b), where b is met once only.
template <typename T>
void gemm(Op op_a, Op op_b, int m, int n, int k, const T* a, int lda, const T* b, int ldb, bool accumulate, T* c,
          int ldc);

}  // namespace graphdrl
