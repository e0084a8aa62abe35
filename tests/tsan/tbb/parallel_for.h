#pragma once
// tbb::parallel_for for builds with the thread sanitizer. That sees nothing of how the prebuilt oneTBB hands work from
// one thread to another and takes whatever a task reads for a race. These are plain threads, which it knows, and the
// pieces are dealt out in turn, so that it is no matter of luck whether two threads meet.

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace tbb {

/// body(piece) for pieces of the range, none shorter than its grain but for the last, on as many threads as oneTBB may
/// use, this one among them. As there, the first exception ends it and is thrown on.
template <class Value, class Body>
void parallel_for(const blocked_range<Value>& range, const Body& body) {
  if (range.empty()) return;
  constexpr std::size_t kPiecesPerThread = 16;
  const std::size_t threads = global_control::active_value(global_control::max_allowed_parallelism);
  const std::size_t size = range.size(), grain = std::max(range.grainsize(), size / (threads * kPiecesPerThread));
  const std::size_t pieces = (size + grain - 1) / grain;
  const auto at = [&](std::size_t k) { return range.begin() + static_cast<Value>(std::min(size, k * grain)); };
  std::atomic<bool> over = false;
  std::exception_ptr thrown;
  const auto work = [&](std::size_t thread) {
    try {
      for (std::size_t k = thread; k < pieces && !over.load(std::memory_order_relaxed); k += threads)
        body(blocked_range<Value>(at(k), at(k + 1), range.grainsize()));
    } catch (...) {
      if (!over.exchange(true, std::memory_order_relaxed)) thrown = std::current_exception();
    }
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t thread = 1; thread < std::min(threads, pieces); ++thread) others.emplace_back(work, thread);
    work(0);
  }
  if (thrown) std::rethrow_exception(thrown);
}

/// f(k) for k = first … last − 1.
template <class Index, class Function>
void parallel_for(Index first, Index last, const Function& f) {
  parallel_for(blocked_range<Index>(first, last), [&](const blocked_range<Index>& some) {
    for (Index k = some.begin(); k < some.end(); ++k) f(k);
  });
}

}  // namespace tbb
