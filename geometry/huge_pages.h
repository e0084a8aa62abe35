#pragma once
// Memory for large arrays that are read here and there: in pages of 2 MB, where the system has them, so that few reads
// wait for the translation of their address.

#include <cstddef>
#include <vector>

namespace exitance {

void* allocate_in_huge_pages(std::size_t bytes, std::size_t alignment);
void free_in_huge_pages(void* memory, std::size_t bytes, std::size_t alignment) noexcept;

template <class T>
struct HugePages {
  using value_type = T;
  HugePages() = default;
  template <class U>
  HugePages(const HugePages<U>&) noexcept {}

  T* allocate(std::size_t n) { return static_cast<T*>(allocate_in_huge_pages(n * sizeof(T), alignof(T))); }
  void deallocate(T* p, std::size_t n) noexcept { free_in_huge_pages(p, n * sizeof(T), alignof(T)); }
  template <class U>
  bool operator==(const HugePages<U>&) const noexcept {
    return true;
  }
};

template <class T>
using LargeArray = std::vector<T, HugePages<T>>;

}  // namespace exitance
