#include "system/large_products.hpp"

#include <mutex>

#include <cblas.h>

namespace signorini {
namespace {

/// Some hundredths of a second of a core: threads that have shared one look out for the next for as long.
constexpr double kLarge = 3e8;

/// Of the process, as the threads of OpenBLAS are.
struct Threads {
  std::mutex mutex;
  int for_large = 1;
  int users = 0;
};

Threads& threads() {
  static Threads all;
  return all;
}

}  // namespace

void share_large_products(int count) {
  const std::lock_guard lock(threads().mutex);
  threads().for_large = count;
  openblas_set_num_threads(1);
}

LargeProducts::LargeProducts(double multiplications) : are_shared_(multiplications >= kLarge) {
  if (!are_shared_) return;
  const std::lock_guard lock(threads().mutex);
  if (threads().users++ == 0 && threads().for_large > 1) openblas_set_num_threads(threads().for_large);
}

LargeProducts::~LargeProducts() {
  if (!are_shared_) return;
  const std::lock_guard lock(threads().mutex);
  if (--threads().users == 0 && threads().for_large > 1) openblas_set_num_threads(1);
}

}  // namespace signorini
