// A message encoded by the code of fastddsgen, which is the form sent over DDS.
#pragma once

#include <cstddef>
#include <vector>

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

namespace topogeo::recording {

template <typename Message>
std::vector<std::byte> by_fast_cdr(const Message& message,
                                   eprosima::fastcdr::Cdr::Endianness order) {
  std::vector<char> zeros(4096);  // it does not overwrite the padding
  eprosima::fastcdr::FastBuffer buffer(zeros.data(), zeros.size());
  eprosima::fastcdr::Cdr cdr(buffer, order, eprosima::fastcdr::Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  message.serialize(cdr);
  const auto* first = reinterpret_cast<const std::byte*>(buffer.getBuffer());
  return {first, first + cdr.getSerializedDataLength()};
}

}  // namespace topogeo::recording
