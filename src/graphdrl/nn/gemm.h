// Row-major matrix products C = op(A) op(B) + β · C, on CBLAS.
#pragma once

#include <cblas.h>

#include <vector>

namespace graphdrl {

enum class Op { kNone, kTranspose };

// One product: a: [m, k] (or [k, m] transposed) with rows `lda` apart; b: [k, n] (or [n, k]); c: [m, n].
struct GemmCall {
  Op op_a;
  Op op_b;
  int m;
  int n;
  int k;
  int lda;
  int ldb;
  int ldc;
  float beta;
};

// Where this thread notes its float products, for benchmarks; null to note nothing.
inline thread_local std::vector<GemmCall>* gemm_log = nullptr;

inline CBLAS_TRANSPOSE cblas_op(Op op) {
  return op == Op::kNone ? CblasNoTrans : CblasTrans;
}

inline void gemm(const GemmCall& call, const float* a, const float* b, float* c) {
  cblas_sgemm(CblasRowMajor, cblas_op(call.op_a), cblas_op(call.op_b), call.m, call.n, call.k, 1.0f, a, call.lda, b,
              call.ldb, call.beta, c, call.ldc);
}

inline void gemm(Op op_a, Op op_b, int m, int n, int k, const float* a, int lda, const float* b, int ldb, float beta,
                 float* c, int ldc) {
  const GemmCall call{op_a, op_b, m, n, k, lda, ldb, ldc, beta};
  if (gemm_log != nullptr) gemm_log->push_back(call);
  gemm(call, a, b, c);
}

inline void gemm(Op op_a, Op op_b, int m, int n, int k, const double* a, int lda, const double* b, int ldb, double beta,
                 double* c, int ldc) {
  cblas_dgemm(CblasRowMajor, cblas_op(op_a), cblas_op(op_b), m, n, k, 1.0, a, lda, b, ldb, beta, c, ldc);
}

}  // namespace graphdrl
