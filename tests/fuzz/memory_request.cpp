#include "tests/fuzz/memory_request.h"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> largest{0};

}  // namespace

void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  if (size > largest) largest = size;
  return std::malloc(size > 0 ? size : 1);
}
void* operator new(std::size_t size) {
  if (void* p = operator new(size, std::nothrow)) return p;
  throw std::bad_alloc();
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}

namespace exitance {

std::size_t largest_memory_request() {
  return largest;
}
void forget_memory_requests() {
  largest = 0;
}
std::size_t memory_held() {
  const auto held = mallinfo2();
  return held.uordblks + held.hblkhd;
}

}  // namespace exitance
