// Pointer to an own value, which is copied with it: for parts of a class whose headers its users
// need not include.
#pragma once

#include <memory>
#include <utility>

namespace topogeo::support {

/// Where a pointer is created, copied or destroyed, T must be complete. A moved-from pointer can
/// only be assigned to or destroyed.
template <typename T>
class ValuePointer {
 public:
  template <typename... Arguments>
  explicit ValuePointer(std::in_place_t, Arguments&&... arguments)
      : value_(new T{std::forward<Arguments>(arguments)...}) {}
  ValuePointer(const ValuePointer& other) : value_(std::make_unique<T>(*other.value_)) {}
  ValuePointer(ValuePointer&&) noexcept = default;
  ValuePointer& operator=(ValuePointer other) noexcept {
    value_ = std::move(other.value_);
    return *this;
  }
  ~ValuePointer() = default;

  T& operator*() { return *value_; }
  const T& operator*() const { return *value_; }
  T* operator->() { return value_.get(); }
  const T* operator->() const { return value_.get(); }

 private:
  std::unique_ptr<T> value_;
};

}  // namespace topogeo::support
