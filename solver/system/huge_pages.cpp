#include "system/huge_pages.hpp"

#include <cstdint>

#include <sys/mman.h>

namespace signorini {

void prefer_huge_pages(void* memory, std::size_t bytes) {
#ifdef MADV_HUGEPAGE
  constexpr std::uintptr_t page = std::uintptr_t{2} << 20;
  // What is larger malloc() takes from the system for itself, and gives back with the mark that this leaves.
  constexpr std::size_t least = std::size_t{32} << 20;
  if (bytes <= least) return;
  const auto first = reinterpret_cast<std::uintptr_t>(memory);
  const std::uintptr_t begin = (first + page - 1) / page * page, end = (first + bytes) / page * page;
  // A system that has none goes on with its own.
  if (begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
#else
  static_cast<void>(memory);
  static_cast<void>(bytes);
#endif
}

}  // namespace signorini
