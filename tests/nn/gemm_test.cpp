#include "graphdrl/nn/gemm.h"

#include <gtest/gtest.h>

#include <cmath>

#include "graphdrl/base/random.h"

namespace graphdrl {
namespace {

template <typename T>
std::vector<T> random_values(std::size_t count, Rng& rng) {
  std::vector<T> values(count);
  for (T& value : values) value = static_cast<T>(2 * rng.uniform() - 1);
  return values;
}

template <typename T>
T at(const std::vector<T>& matrix, Op op, int stride, int row, int column) {
  return op == Op::kNone ? matrix[row * stride + column] : matrix[column * stride + row];
}

// Every shape's product against a sum in double; `stride` leaves gaps behind the rows of a and c, which must stay.
template <typename T>
void check_product(Op op_a, Op op_b, int m, int n, int k, bool accumulate, Rng& rng) {
  const int lda = (op_a == Op::kNone ? k : m) + 3;
  const int ldb = (op_b == Op::kNone ? n : k) + 1;
  const int ldc = n + 5;
  const auto a = random_values<T>(static_cast<std::size_t>(lda) * (op_a == Op::kNone ? m : k), rng);
  const auto b = random_values<T>(static_cast<std::size_t>(ldb) * (op_b == Op::kNone ? k : n), rng);
  const auto before = random_values<T>(static_cast<std::size_t>(ldc) * m, rng);
  auto c = before;
  gemm(op_a, op_b, m, n, k, a.data(), lda, b.data(), ldb, accumulate, c.data(), ldc);
  for (int i = 0; i < m; ++i) {
    for (int j = 0; j < ldc; ++j) {
      double sum = accumulate || j >= n ? before[i * ldc + j] : 0;
      for (int p = 0; j < n && p < k; ++p) sum += double{at(a, op_a, lda, i, p)} * at(b, op_b, ldb, p, j);
      ASSERT_NEAR(c[i * ldc + j], sum, 1e-6 * (k + 1)) << m << " x " << n << " x " << k << " at " << i << ", " << j;
    }
  }
}

TEST(Gemm, EveryShapeAndLayoutIsTheSumOfProducts) {
  Rng rng(3);
  for (const Op op_a : {Op::kNone, Op::kTranspose}) {
    for (const Op op_b : {Op::kNone, Op::kTranspose}) {
      for (const int m : {1, 2, 11, 12, 13, 25, 100}) {
        for (const int n : {1, 7, 16, 21, 32, 33, 64, 96}) {
          for (const int k : {1, 7, 40}) {
            check_product<float>(op_a, op_b, m, n, k, false, rng);
            check_product<float>(op_a, op_b, m, n, k, true, rng);
            check_product<double>(op_a, op_b, m, n, k, true, rng);
          }
        }
      }
    }
  }
}

TEST(Gemm, APackedMatrixIsReadInPartAndTurned) {
  Rng rng(4);
  const int rows = 37;
  const int columns = 50;
  const auto b = random_values<float>(rows * columns, rng);
  PackedMatrix<float> packed;
  packed.set(rows, columns, Op::kNone, b.data(), columns);
  PackedMatrix<float> turned;
  turned.set_transposed(packed);
  ASSERT_EQ(turned.rows(), columns);
  ASSERT_EQ(turned.columns(), rows);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      EXPECT_EQ(packed.panel(j / 32)[i * 32 + j % 32], b[i * columns + j]);
      EXPECT_EQ(turned.panel(i / 32)[j * 32 + i % 32], b[i * columns + j]);
    }
  }
  const auto a = random_values<float>(5 * rows, rng);
  std::vector<float> part(5 * 40);
  gemm(Op::kNone, 5, 40, 20, a.data(), rows, packed, false, part.data(), 40);  // 20 of 37 rows, 40 of 50 columns
  std::vector<float> expected(5 * 40);
  gemm(Op::kNone, Op::kNone, 5, 40, 20, a.data(), rows, b.data(), columns, false, expected.data(), 40);
  EXPECT_EQ(part, expected);

  PackedMatrix<float> product;
  gemm(5, a.data(), rows, packed, product);
  std::vector<float> whole(5 * columns);
  gemm(Op::kNone, 5, columns, rows, a.data(), rows, packed, false, whole.data(), columns);
  for (int i = 0; i < 5; ++i) {
    for (int j = 0; j < columns; ++j) EXPECT_EQ(product.panel(j / 32)[i * 32 + j % 32], whole[i * columns + j]);
  }
}

TEST(Gemm, EveryInstructionSetAgrees) {
  Rng rng(5);
  std::vector<void (*)(const GemmTask<float>&)> kernels;
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) kernels.push_back(avx2::multiply);
  if (__builtin_cpu_supports("avx512f")) kernels.push_back(avx512::multiply);
#endif
  const auto b = random_values<float>(50 * 32, rng);
  PackedMatrix<float> packed;
  packed.set(50, 32, Op::kNone, b.data(), 32);
  for (const bool transposed : {false, true}) {
    for (const int m : {1, 5, 6, 7, 12, 30}) {
      for (const int columns : {3, 16, 20, 32}) {
        const auto a = random_values<float>(50 * 50, rng);
        std::vector<float> plain_c(30 * 32, 0.5f);
        GemmTask<float> task{.transposed = transposed,
                             .accumulate = true,
                             .m = m,
                             .k = 50,
                             .columns = columns,
                             .a = a.data(),
                             .lda = 50,
                             .panel = packed.panel(0),
                             .c = plain_c.data(),
                             .ldc = 32};
        plain::multiply(task);
        std::vector<float> first;
        for (const auto kernel : kernels) {
          std::vector<float> c(30 * 32, 0.5f);
          task.c = c.data();
          kernel(task);
          for (std::size_t i = 0; i < c.size(); ++i) ASSERT_NEAR(c[i], plain_c[i], 2e-5);
          if (first.empty()) first = c;
          EXPECT_EQ(c, first);  // the same bytes
        }
      }
    }
  }
}

}  // namespace
}  // namespace graphdrl
