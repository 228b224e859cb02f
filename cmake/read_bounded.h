// How the code of fastddsgen reads the bounded sequences of our messages (cmake/idl_bounds.py).
#pragma once

#include <cstdint>
#include <vector>

#include <fastcdr/Cdr.h>
#include <fastcdr/exceptions/BadParamException.h>
#include <fastcdr/exceptions/NotEnoughMemoryException.h>

namespace topogeo::msg {

/// Reads the number of elements that a sequence claims and goes back to its start.
inline std::uint32_t claimed_count(eprosima::fastcdr::Cdr& cdr) {
  std::uint32_t count = 0;
#if __has_include(<fastcdr/CdrEncoding.hpp>)  // Fast CDR 2
  // In the second version of the encoding a size stands before the number.
  if (cdr.get_cdr_version() == eprosima::fastcdr::CdrVersion::XCDRv2) {
    throw eprosima::fastcdr::exception::BadParamException("a sequence in another encoding");
  }
  const eprosima::fastcdr::Cdr::state start = cdr.get_state();
  cdr >> count;
  cdr.set_state(start);
#else
  eprosima::fastcdr::Cdr::state start = cdr.getState();
  cdr >> count;
  cdr.setState(start);
#endif
  return count;
}

/// Reads a sequence of at most `bound` elements. Throws NotEnoughMemoryException when it claims
/// more: the library makes room for as many as there are bytes left, each of which may take a
/// hundred, before it reads the first, and a peer can claim what it likes.
template <class T>
void read_bounded(eprosima::fastcdr::Cdr& cdr, std::vector<T>& sequence, std::uint32_t bound) {
  if (claimed_count(cdr) > bound) {
    throw eprosima::fastcdr::exception::NotEnoughMemoryException("a sequence beyond its bound");
  }
  cdr >> sequence;
}

}  // namespace topogeo::msg
