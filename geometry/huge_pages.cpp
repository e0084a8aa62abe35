#include "geometry/huge_pages.h"

#include <sys/mman.h>

#include <new>

namespace exitance {
namespace {

constexpr std::size_t kPage = std::size_t{1} << 21;

std::align_val_t aligned(std::size_t bytes, std::size_t alignment) {
  return std::align_val_t{bytes < kPage ? alignment : kPage};
}

}  // namespace

void* allocate_in_huge_pages(std::size_t bytes, std::size_t alignment) {
  void* const memory = ::operator new(bytes, aligned(bytes, alignment));
#ifdef MADV_HUGEPAGE
  // Whole pages only, so that no more memory is taken. A system that has none says so, and its own pages do as well.
  if (bytes >= kPage) (void)madvise(memory, bytes / kPage * kPage, MADV_HUGEPAGE);
#endif
  return memory;
}

void free_in_huge_pages(void* memory, std::size_t bytes, std::size_t alignment) noexcept {
  ::operator delete(memory, aligned(bytes, alignment));
}

}  // namespace exitance
