// Readers and writers of message fields; see ros_codec.hpp.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "topogeo/recording/ros_codec.hpp"

namespace topogeo::recording {

static_assert(std::endian::native == std::endian::little);

template <typename Value>
concept Number = std::is_arithmetic_v<Value>;

/// Reads the fields of a message one by one. CDR aligns numbers to their size, counted from the end
/// of the encapsulation header; ROS 1 does not align them.
template <Encoding kEncoding>
class FieldReader {
 public:
  explicit FieldReader(std::span<const std::byte> bytes) : bytes_(bytes) {
    if constexpr (kEncoding == Encoding::kCdr) {
      constexpr std::size_t kEncapsulation = 4;
      const std::span<const std::byte> head = take(kEncapsulation);
      if (head[0] != std::byte{0} || head[1] > std::byte{1}) {
        throw DecodeError(
            "byte 0: expected plain CDR, got representation " +
            std::to_string(std::to_integer<int>(head[0]) * 256 + std::to_integer<int>(head[1])));
      }
      swap_ = head[1] == std::byte{0};
      origin_ = kEncapsulation;
    }
  }

  void ros1_sequence() {
    if constexpr (kEncoding == Encoding::kRos1) take(sizeof(std::uint32_t));
  }

  template <Number Value>
  void operator()(Value& value) {
    align(sizeof(Value));
    read(take(sizeof(Value)), &value);
  }

  void operator()(bool& value) {
    std::uint8_t byte = 0;
    (*this)(byte);
    value = byte != 0;
  }

  void operator()(std::string& text) {
    std::uint32_t length = 0;
    (*this)(length);
    const std::span<const std::byte> characters = take(length);
    text.assign(reinterpret_cast<const char*>(characters.data()), characters.size());
    if (kEncoding == Encoding::kCdr && !text.empty() && text.back() == '\0') text.pop_back();
  }

  template <Number Value, std::size_t kCount>
  void operator()(std::array<Value, kCount>& values) {
    align(sizeof(Value));
    read(take(sizeof(Value) * kCount), values.data());
  }

  template <Number Value>
  void operator()(std::vector<Value>& values) {
    std::uint32_t count = 0;
    (*this)(count);
    if (count > 0) align(sizeof(Value));
    const std::span<const std::byte> bytes = take(std::size_t{count} * sizeof(Value));
    values.resize(count);
    if (count > 0) read(bytes, values.data());
  }

  template <typename Value>
  void operator()(std::vector<Value>& values) {
    std::uint32_t count = 0;
    (*this)(count);
    values.clear();
    for (std::uint32_t i = 0; i < count; ++i) (*this)(values.emplace_back());
  }

  template <typename Message>
  requires std::is_class_v<Message>
  void operator()(Message& message) { fields(*this, message); }

 private:
  void align(std::size_t size) {
    if constexpr (kEncoding == Encoding::kCdr) {
      const std::size_t padding = (size - (at_ - origin_) % size) % size;
      take(padding);
    }
  }

  std::span<const std::byte> take(std::size_t count) {
    if (count > bytes_.size() - at_) {
      throw DecodeError("byte " + std::to_string(at_) + ": expected " + std::to_string(count) +
                        " bytes more, got " + std::to_string(bytes_.size() - at_));
    }
    return bytes_.subspan(std::exchange(at_, at_ + count), count);
  }

  template <typename Value>
  void read(std::span<const std::byte> from, Value* to) const {
    std::memcpy(to, from.data(), from.size());
    if (!swap_) return;
    for (std::size_t i = 0; i < from.size(); i += sizeof(Value)) {
      auto* value = reinterpret_cast<std::byte*>(to) + i;
      for (std::size_t j = 0; j < sizeof(Value) / 2; ++j) {
        std::swap(value[j], value[sizeof(Value) - 1 - j]);
      }
    }
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::size_t origin_ = 0;
  bool swap_ = false;
};

template <Encoding kEncoding>
class FieldWriter {
 public:
  explicit FieldWriter(std::vector<std::byte>& bytes) : bytes_(bytes), origin_(bytes.size()) {
    if constexpr (kEncoding == Encoding::kCdr) {
      for (const int byte : {0, 1, 0, 0}) bytes_.push_back(static_cast<std::byte>(byte));
      origin_ = bytes_.size();
    }
  }

  void ros1_sequence() {
    if constexpr (kEncoding == Encoding::kRos1) (*this)(std::uint32_t{0});
  }

  template <Number Value>
  void operator()(const Value& value) {
    align(sizeof(Value));
    append(&value, sizeof(Value));
  }

  void operator()(const std::string& text) {
    constexpr std::size_t kEnd = kEncoding == Encoding::kCdr ? 1 : 0;
    (*this)(static_cast<std::uint32_t>(text.size() + kEnd));
    append(text.c_str(), text.size() + kEnd);
  }

  template <Number Value, std::size_t kCount>
  void operator()(const std::array<Value, kCount>& values) {
    align(sizeof(Value));
    append(values.data(), sizeof(Value) * kCount);
  }

  template <typename Value>
  void operator()(const std::vector<Value>& values) {
    (*this)(static_cast<std::uint32_t>(values.size()));
    if constexpr (Number<Value>) {
      if (values.empty()) return;
      align(sizeof(Value));
      append(values.data(), sizeof(Value) * values.size());
    } else {
      for (const Value& value : values) (*this)(value);
    }
  }

  template <typename Message>
  requires std::is_class_v<Message>
  void operator()(const Message& message) { fields(*this, message); }

 private:
  void align(std::size_t size) {
    if constexpr (kEncoding == Encoding::kCdr) {
      const std::size_t padding = (size - (bytes_.size() - origin_) % size) % size;
      bytes_.resize(bytes_.size() + padding);
    }
  }

  void append(const void* from, std::size_t count) {
    const auto* first = static_cast<const std::byte*>(from);
    bytes_.insert(bytes_.end(), first, first + count);
  }

  std::vector<std::byte>& bytes_;
  std::size_t origin_;
};

}  // namespace topogeo::recording
