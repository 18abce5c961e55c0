#pragma once

namespace signorini {

/// From now on BLAS has so many threads for large products, and one for all others: to share a small one
/// takes longer than to compute it, and many times as long while others want the cores. Before that, and
/// where it is never called, BLAS has the threads that it takes.
void share_large_products(int threads);

/// While it lives, BLAS has the threads for large products if so many multiplications are worth them.
class LargeProducts {
 public:
  explicit LargeProducts(double multiplications);
  ~LargeProducts();

  LargeProducts(const LargeProducts&) = delete;
  LargeProducts& operator=(const LargeProducts&) = delete;

 private:
  const bool are_shared_;
};

}  // namespace signorini
