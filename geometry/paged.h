#pragma once
// An array whose copies share what they have in common.

#include <array>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace exitance {

/// Elements in pages of kPage; a page is copied when one of its elements is to be changed while another array has it,
/// too. A copy takes time and memory by the number of pages. Any number of threads may read what none changes.
template <class T, std::size_t kPage = 64>
class Paged {
 public:
  /// All elements are T{}.
  explicit Paged(std::size_t size = 0) { resize(size); }

  /// New elements are T{}; they share pages until they are changed. Never shrinks.
  void resize(std::size_t size) {
    if (pages_.size() * kPage < size) pages_.resize((size + kPage - 1) / kPage, std::make_shared<Page>());
  }

  const T& operator[](std::size_t i) const { return (*pages_[i / kPage])[i % kPage]; }

  /// To be changed.
  T& own(std::size_t i) {
    std::shared_ptr<Page>& page = pages_[i / kPage];
    if (page.use_count() > 1) page = std::make_shared<Page>(*page);
    return (*page)[i % kPage];
  }
  void set(std::size_t i, T value) { own(i) = std::move(value); }

 private:
  using Page = std::array<T, kPage>;

  std::vector<std::shared_ptr<Page>> pages_;
};

}  // namespace exitance
