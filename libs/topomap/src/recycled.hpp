// Refills a vector whose elements, and surplus elements of earlier fills, keep their memory.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace topogeo::topomap {

/// Between open() and close(), add() returns the next element with its old content. close() moves
/// the remaining elements to a store, from which add() takes them back when needed.
template <typename Element>
class Recycled {
 public:
  void open(std::vector<Element>& elements) {
    elements_ = &elements;
    used_ = 0;
  }
  Element& add() {
    if (used_ == elements_->size()) {
      if (spare_.empty()) {
        elements_->emplace_back();
      } else {
        elements_->push_back(std::move(spare_.back()));
        spare_.pop_back();
      }
    }
    return (*elements_)[used_++];
  }
  [[nodiscard]] std::size_t size() const { return used_; }
  void close() {
    while (elements_->size() > used_) {
      spare_.push_back(std::move(elements_->back()));
      elements_->pop_back();
    }
    elements_ = nullptr;
  }

 private:
  std::vector<Element>* elements_ = nullptr;
  std::vector<Element> spare_;
  std::size_t used_ = 0;
};

}  // namespace topogeo::topomap
