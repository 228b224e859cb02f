// Helpers to fill generated messages.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

#include "topogeo/msg/common.h"
#include "topogeo/support/hash.hpp"

namespace topogeo::messaging {

/// Assigns a bounded string. Throws std::invalid_argument when `text` is longer than the bound or
/// has a zero byte; plain assignment would cut it silently.
template <class BoundedString>
void set_text(BoundedString& field, std::string_view text, const char* field_name) {
  if (text.size() > BoundedString::max_size || text.find('\0') != std::string_view::npos) {
    throw std::invalid_argument(std::string(field_name) + ": '" + std::string(text) +
                                "': expected at most " + std::to_string(BoundedString::max_size) +
                                " bytes, none of them zero");
  }
  field = std::string(text);
}

/// Assigns a bounded string, cut at a UTF-8 character to its bound: for readable texts.
template <class BoundedString>
void set_text_cut(BoundedString& field, std::string_view text) {
  std::size_t size = std::min(text.size(), static_cast<std::size_t>(BoundedString::max_size));
  if (size < text.size()) {
    while (size > 0 && (static_cast<unsigned char>(text[size]) & 0xC0U) == 0x80U) --size;
  }
  field = std::string(text.substr(0, size));
}

/// The number that represents a text in the key of a topic; 0 for an empty text.
inline std::uint64_t key_of(std::string_view text) {
  return text.empty() ? 0 : support::fnv1a(text);
}

/// Sets robot_id and, where the message has it, its key. Throws like set_text.
template <class Message>
void set_robot_id(Message& message, std::string_view robot_id) {
  set_text(message.robot_id(), robot_id, "robot_id");
  if constexpr (requires { message.robot_key(); }) message.robot_key(key_of(robot_id));
}

/// The same for worker_id.
template <class Message>
void set_worker_id(Message& message, std::string_view worker_id) {
  set_text(message.worker_id(), worker_id, "worker_id");
  if constexpr (requires { message.worker_key(); }) message.worker_key(key_of(worker_id));
}

/// The same for client_id.
template <class Message>
void set_client_id(Message& message, std::string_view client_id) {
  set_text(message.client_id(), client_id, "client_id");
  if constexpr (requires { message.client_key(); }) message.client_key(key_of(client_id));
}

/// Sets the name and the instance of a service, and their keys. Throws like set_text.
template <class Status>
void set_service(Status& status, std::string_view service, std::string_view instance) {
  set_text(status.service(), service, "service");
  set_text(status.instance(), instance, "instance");
  status.service_key(key_of(service));
  status.instance_key(key_of(instance));
}

/// Sets the fields that every message starts with. Throws like set_text.
template <class Message>
void set_header(Message& message, std::string_view robot_id, std::int64_t stamp_ns,
                std::uint64_t sequence_number) {
  message.schema_version(msg::kSchemaVersion);
  set_robot_id(message, robot_id);
  message.stamp_ns(stamp_ns);
  message.sequence_number(sequence_number);
}

}  // namespace topogeo::messaging
