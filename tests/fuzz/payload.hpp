// Payloads of samples as readers get them and as writers send them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include <fastdds/dds/topic/TypeSupport.hpp>

#include "checks.hpp"

namespace topogeo::fuzz {

using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;

/// The bytes of a payload, with the room that the middleware leaves behind them: none.
struct Arrived {
  explicit Arrived(std::string_view bytes)
      : payload(static_cast<std::uint32_t>(std::max<std::size_t>(1, bytes.size()))) {
    std::ranges::copy(bytes, payload.data);
    payload.length = static_cast<std::uint32_t>(bytes.size());
  }
  Payload payload;
};

template <class Message>
std::string written_payload(const Message& message, eprosima::fastdds::dds::TypeSupport& type) {
  void* const data = const_cast<Message*>(&message);  // NOLINT: their interface; it only reads
  Payload payload(type.get_serialized_size_provider(data)());
  require(type.serialize(data, &payload), "a message without a defect can be sent");
  return {reinterpret_cast<const char*>(payload.data), payload.length};  // NOLINT: bytes
}

}  // namespace topogeo::fuzz
