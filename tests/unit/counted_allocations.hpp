// Replaces operator new of the program to count allocations. Include it in one source file of a
// dedicated test program.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace topogeo::test {

/// Allocations since the start of the program, in all threads.
inline std::atomic<std::size_t> allocations{0};

inline void* allocate_counted(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc{};
}

}  // namespace topogeo::test

// NOLINTBEGIN(misc-definitions-in-headers): included once in a program
void* operator new(std::size_t size) {
  return topogeo::test::allocate_counted(size);
}
void* operator new[](std::size_t size) {
  return topogeo::test::allocate_counted(size);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t /*size*/) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t /*size*/) noexcept {
  std::free(memory);
}
// NOLINTEND(misc-definitions-in-headers)
