// Payloads of samples in the form of readers and writers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fastdds/dds/topic/TypeSupport.hpp>

#include "topogeo/messaging/detail/type_support.hpp"

#include "checks.hpp"

namespace topogeo::fuzz {

using messaging::Payload;

/// A payload without spare bytes at its end, as the middleware passes it.
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
  Payload payload(messaging::detail::payload_size(type, data));
  require(messaging::detail::write_payload(type, data, payload),
          "a message without a defect can be sent");
  return {reinterpret_cast<const char*>(payload.data), payload.length};  // NOLINT: bytes
}

/// Kind of the payload, named in the first line of an input.
struct MessageKind {
  std::string_view name;
  std::size_t (*check)(std::string_view payload);
  std::string (*sample)();  ///< a payload that passes
};

/// Runs the check of the kind that the input names; returns 0 when it names none.
inline std::size_t check_named(std::span<const MessageKind> kinds, std::string_view bytes) {
  const std::size_t end = bytes.find('\n');
  const auto kind = std::ranges::find(kinds, bytes.substr(0, end), &MessageKind::name);
  if (end == std::string_view::npos || kind == kinds.end()) return 0;
  return kind->check(bytes.substr(end + 1));
}

/// An input of each kind.
inline std::vector<std::string> sample_inputs(std::span<const MessageKind> kinds) {
  std::vector<std::string> inputs;
  for (const MessageKind& kind : kinds) {
    inputs.push_back(std::string(kind.name) + "\n" + kind.sample());
  }
  return inputs;
}

}  // namespace topogeo::fuzz
