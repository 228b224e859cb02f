// Reads bags of ROS 1, version 2.0 (http://wiki.ros.org/Bags/Format/2.0), from front to back.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>

#include "chunked_source.hpp"

namespace topogeo::recording {

class BagSource final : public ChunkedSource {
 public:
  /// Throws std::runtime_error.
  BagSource(const std::filesystem::path& path, TopicFilter wanted);

 private:
  using Fields = std::map<std::string, std::span<const std::byte>, std::less<>>;

  bool read_record(RawMessage& message) override;
  bool read_record_of_chunk(Cursor& cursor, RawMessage& message) override;
  /// Takes connections and messages, from any place.
  bool take(const Fields& header, std::span<const std::byte> data, RawMessage& message);
  void take_connection(const Fields& header, std::span<const std::byte> data);
  void open_chunk(const Fields& header, std::span<const std::byte> data);

  std::map<std::uint32_t, Channel> connections_;
};

}  // namespace topogeo::recording
