#pragma once
// Rows made in parallel and used in order.

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace exitance {

/// make(k) for k = 0 … count − 1, in parallel; sink(row) for each, in order; done(n) whenever the first n rows have
/// been used: after every block. Blocks are to be small enough to report progress between them and large enough to keep
/// all threads busy.
template <class Make, class Sink, class Done>
void for_each_row(std::size_t count, std::size_t block, const Make& make, const Sink& sink, const Done& done) {
  std::vector<decltype(make(std::size_t{}))> rows;
  for (std::size_t first = 0; first < count; first += block) {
    const std::size_t last = std::min(count, first + block);
    rows.clear();
    rows.resize(last - first);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(first, last, 1), [&](const auto& some) {
      for (std::size_t k = some.begin(); k < some.end(); ++k) rows[k - first] = make(k);
    });
    for (const auto& row : rows) sink(row);
    done(last);
  }
}

}  // namespace exitance
