// BLAS has one thread but for large products.
#include <gtest/gtest.h>

#include <cblas.h>

#include "system/large_products.hpp"

namespace signorini::large_products_test {
namespace {

/// Found on a busy machine: 100 entries of a sweep took 123 s in place of 2, for each of their small products
/// waited until a thread had a core.
TEST(LargeProducts, HaveTheThreadsAlone) {
  constexpr double small = 1e6, large = 1e12;
  const int before = openblas_get_num_threads();
  share_large_products(2);
  EXPECT_EQ(openblas_get_num_threads(), 1);
  {
    const LargeProducts few(small);
    EXPECT_EQ(openblas_get_num_threads(), 1);
    const LargeProducts many(large);
    EXPECT_EQ(openblas_get_num_threads(), 2);
    { const LargeProducts within(large); }
    EXPECT_EQ(openblas_get_num_threads(), 2);
  }
  EXPECT_EQ(openblas_get_num_threads(), 1);
  share_large_products(1);
  {
    const LargeProducts many(large);
    EXPECT_EQ(openblas_get_num_threads(), 1);
  }
  openblas_set_num_threads(before);
}

}  // namespace
}  // namespace signorini::large_products_test
