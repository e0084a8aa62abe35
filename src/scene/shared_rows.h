#pragma once
// Arrays whose copies share what they have in common: what versions of a scene that follow each other are made of.

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

#include "geometry/paged.h"

namespace exitance {

/// Rows that may be changed in place, in pages that copies share (paged.h). Reading is safe from any number of threads
/// while none changes this array; changing one array changes no other. Not const, [] may copy a page: to read, read a
/// const array.
template <class T>
class SharedRows {
 public:
  SharedRows() = default;

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }

  const T& operator[](std::size_t i) const { return pages_[i]; }
  T& operator[](std::size_t i) { return pages_.own(i); }
  const T& back() const { return (*this)[size_ - 1]; }
  T& back() { return (*this)[size_ - 1]; }

  /// New rows are T{}; they share pages until they are changed. Never shrinks.
  void resize(std::size_t size) {
    if (size <= size_) return;
    pages_.resize(size);
    size_ = size;
  }
  T& emplace_back() {
    resize(size_ + 1);
    return back();
  }
  void push_back(T row) { emplace_back() = std::move(row); }

  template <class Rows, class Row>
  class Iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = T;
    using difference_type = std::ptrdiff_t;
    using pointer = Row*;
    using reference = Row&;

    Iterator() = default;
    Iterator(Rows* rows, std::size_t i) : rows_(rows), i_(i) {}
    Row& operator*() const { return (*rows_)[i_]; }
    Iterator& operator++() {
      ++i_;
      return *this;
    }
    Iterator operator++(int) { return {rows_, i_++}; }
    bool operator==(const Iterator& other) const { return i_ == other.i_; }

   private:
    Rows* rows_ = nullptr;
    std::size_t i_ = 0;
  };
  auto begin() const { return Iterator<const SharedRows, const T>(this, 0); }
  auto end() const { return Iterator<const SharedRows, const T>(this, size_); }
  auto begin() { return Iterator<SharedRows, T>(this, 0); }
  auto end() { return Iterator<SharedRows, T>(this, size_); }

 private:
  Paged<T, 128> pages_;
  std::size_t size_ = 0;
};

/// Contiguous items, which only grow at the end: a copy that grows shares what it was copied from, as long as there is
/// room behind that and no other copy has grown there. No two threads may make copies grow at a time.
template <class T>
class SharedList {
 public:
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const T* data() const { return items_ ? items_->data() : nullptr; }
  const T& operator[](std::size_t i) const { return (*items_)[i]; }
  const T& back() const { return (*this)[size_ - 1]; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size_; }

  void push_back(const T& item) {
    const T own = item;
    append(&own, &own + 1);
  }
  /// REQUIRES: the range is not of this list.
  template <class Iterator>
  void append(Iterator first, Iterator last) {
    const auto count = static_cast<std::size_t>(std::distance(first, last));
    if (!items_ || items_->size() != size_ || size_ + count > items_->capacity()) {
      auto more = std::make_shared<std::vector<T>>();
      more->reserve(std::max(size_ + count, size_ + size_ / 2));
      more->insert(more->end(), begin(), end());
      items_ = std::move(more);
    }
    items_->insert(items_->end(), first, last);
    size_ += count;
  }
  void set(std::size_t i, const T& item) {
    if (items_.use_count() > 1) items_ = std::make_shared<std::vector<T>>(begin(), end());
    (*items_)[i] = item;
  }

 private:
  std::shared_ptr<std::vector<T>> items_;
  std::size_t size_ = 0;
};

}  // namespace exitance
