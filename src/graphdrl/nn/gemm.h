// Row-major matrix products C = op(A) op(B) + β · C, on CBLAS.
#pragma once

#include <cblas.h>

namespace graphdrl {

enum class Op { kNone, kTranspose };

// a: [m, k] (or [k, m] transposed) with rows `lda` apart; b: [k, n] (or [n, k]); c: [m, n].
inline void gemm(Op op_a, Op op_b, int m, int n, int k, const float* a, int lda, const float* b, int ldb, float beta,
                 float* c, int ldc) {
  cblas_sgemm(CblasRowMajor, op_a == Op::kNone ? CblasNoTrans : CblasTrans,
              op_b == Op::kNone ? CblasNoTrans : CblasTrans, m, n, k, 1.0f, a, lda, b, ldb, beta, c, ldc);
}
inline void gemm(Op op_a, Op op_b, int m, int n, int k, const double* a, int lda, const double* b, int ldb, double beta,
                 double* c, int ldc) {
  cblas_dgemm(CblasRowMajor, op_a == Op::kNone ? CblasNoTrans : CblasTrans,
              op_b == Op::kNone ? CblasNoTrans : CblasTrans, m, n, k, 1.0, a, lda, b, ldb, beta, c, ldc);
}

}  // namespace graphdrl
