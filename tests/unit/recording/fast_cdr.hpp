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
#if __has_include(<fastcdr/CdrEncoding.hpp>)  // Fast CDR 2
  eprosima::fastcdr::Cdr cdr(buffer, order, eprosima::fastcdr::CdrVersion::XCDRv1);
  cdr.set_encoding_flag(eprosima::fastcdr::EncodingAlgorithmFlag::PLAIN_CDR);
  cdr.serialize_encapsulation();
  cdr << message;
  const std::size_t size = cdr.get_serialized_data_length();
#else
  eprosima::fastcdr::Cdr cdr(buffer, order, eprosima::fastcdr::Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  message.serialize(cdr);
  const std::size_t size = cdr.getSerializedDataLength();
#endif
  const auto* first = reinterpret_cast<const std::byte*>(buffer.getBuffer());
  return {first, first + size};
}

}  // namespace topogeo::recording
