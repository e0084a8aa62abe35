#pragma once
// An array whose copies share what they have in common.

#include <array>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace exitance {

/// Elements in pages; a page is copied when one of its elements is set while another array has it, too. A copy takes
/// time and memory by the number of pages. Any number of threads may read what none sets.
template <class T>
class Paged {
 public:
  /// All elements are T{}.
  explicit Paged(std::size_t size = 0) : pages_((size + kPage - 1) / kPage, std::make_shared<Page>()) {}

  const T& operator[](std::size_t i) const { return (*pages_[i / kPage])[i % kPage]; }

  void set(std::size_t i, T value) {
    std::shared_ptr<Page>& page = pages_[i / kPage];
    if (page.use_count() > 1) page = std::make_shared<Page>(*page);
    (*page)[i % kPage] = std::move(value);
  }

 private:
  static constexpr std::size_t kPage = 64;
  using Page = std::array<T, kPage>;

  std::vector<std::shared_ptr<Page>> pages_;
};

}  // namespace exitance
