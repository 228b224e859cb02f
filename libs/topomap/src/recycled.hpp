// Fills a vector anew while its elements, and those that it had too many of before, keep their
// memory.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace topogeo::topomap {

/// Between open() and close() add() gives the next element, with what it last held. The elements
/// that are left over at close() go to a store and come back when there are too few.
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
