// Reads bags of ROS 1, version 2.0 (http://wiki.ros.org/Bags/Format/2.0), from front to back.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/recording/message_source.hpp"

#include "input_file.hpp"

namespace topogeo::recording {

class BagSource final : public MessageSource {
 public:
  /// Throws std::runtime_error.
  BagSource(const std::filesystem::path& path, TopicFilter wanted);

  bool next(RawMessage& message) override;
  [[nodiscard]] const std::vector<Topic>& topics() const override { return topics_; }
  [[nodiscard]] std::string position() const override;
  [[nodiscard]] const std::string& damage() const override { return damage_; }
  [[nodiscard]] double fraction_read() const override;

 private:
  struct Connection {
    std::size_t topic = 0;
    bool wanted = false;
  };
  using Fields = std::map<std::string, std::span<const std::byte>, std::less<>>;

  bool read_record(RawMessage& message);
  bool read_record_of_chunk(RawMessage& message);
  /// Connections and messages, wherever they stand.
  bool take(const Fields& header, std::span<const std::byte> data, RawMessage& message);
  void take_connection(const Fields& header, std::span<const std::byte> data);
  void open_chunk(const Fields& header, std::span<const std::byte> data);

  InputFile file_;
  TopicFilter wanted_;
  std::uint64_t at_ = 0;
  std::uint64_t record_ = 0;
  bool ended_ = false;
  std::vector<std::byte> chunk_;
  std::size_t chunk_at_ = 0;
  std::map<std::uint32_t, Connection> connections_;
  std::vector<Topic> topics_;
  std::string damage_;
};

}  // namespace topogeo::recording
