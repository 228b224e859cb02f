// How the code of fastddsgen reads the bounded sequences of our messages (cmake/idl_bounds.py).
#pragma once

#include <cstdint>
#include <vector>

#include <fastcdr/Cdr.h>
#include <fastcdr/exceptions/NotEnoughMemoryException.h>

namespace topogeo::msg {

/// Reads a sequence of at most `bound` elements. Throws NotEnoughMemoryException when it claims
/// more: the library makes room for as many as there are bytes left, each of which may take a
/// hundred, before it reads the first, and a peer can claim what it likes.
template <class T>
void read_bounded(eprosima::fastcdr::Cdr& cdr, std::vector<T>& sequence, std::uint32_t bound) {
  eprosima::fastcdr::Cdr::state start = cdr.getState();
  std::uint32_t count = 0;
  cdr >> count;
  if (count > bound) {
    throw eprosima::fastcdr::exception::NotEnoughMemoryException("a sequence beyond its bound");
  }
  cdr.setState(start);
  cdr >> sequence;
}

}  // namespace topogeo::msg
