// Helpers to fill generated messages.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include "topogeo/msg/common.h"

namespace topogeo::messaging {

/// Assigns a bounded string. Throws std::invalid_argument when `text` is longer than the bound or
/// has a zero byte; plain assignment would cut it silently.
template <class BoundedString>
void set_text(BoundedString& field, std::string_view text, const char* field_name) {
  if (text.size() > BoundedString::max_size || text.find('\0') != std::string_view::npos) {
    throw std::invalid_argument(std::string(field_name) + ": '" + std::string(text) +
                                "' does not fit, allowed are " +
                                std::to_string(BoundedString::max_size) + " bytes, none zero");
  }
  field = std::string(text);
}

/// Assigns a bounded string, cut to its bound at a character of UTF-8: for texts for people.
template <class BoundedString>
void set_text_cut(BoundedString& field, std::string_view text) {
  std::size_t size = std::min(text.size(), static_cast<std::size_t>(BoundedString::max_size));
  if (size < text.size()) {
    while (size > 0 && (static_cast<unsigned char>(text[size]) & 0xC0U) == 0x80U) --size;
  }
  field = std::string(text.substr(0, size));
}

/// Sets the fields that every message starts with. Throws like set_text.
template <class Message>
void set_header(Message& message, std::string_view robot_id, std::int64_t stamp_ns,
                std::uint64_t sequence_number) {
  message.schema_version(msg::kSchemaVersion);
  set_text(message.robot_id(), robot_id, "robot_id");
  message.stamp_ns(stamp_ns);
  message.sequence_number(sequence_number);
}

}  // namespace topogeo::messaging
