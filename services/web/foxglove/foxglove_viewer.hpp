// A client that watches through Foxglove's WebSocket protocol, such as Foxglove and Lichtblick.
//
// It may only subscribe. Changed topics are sent in turn: the one sent longest ago goes next.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "foxglove/foxglove_topics.hpp"
#include "server/json_values.hpp"
#include "server/watcher.hpp"

namespace topogeo::web {

/// The supported name in the header Sec-WebSocket-Protocol; empty: none.
std::string foxglove_subprotocol(std::string_view offered);

/// A frame with a message: opcode 1, subscription id, time, payload.
std::string message_data(std::uint32_t subscription, std::int64_t time_ns,
                         std::string_view payload);

class FoxgloveViewer : public Watcher {
 public:
  using Watcher::Watcher;

 private:
  struct Subscription {
    const FoxgloveTopic* topic = nullptr;
    std::uint64_t held = 0;  // version
    std::uint64_t turn = 0;  // number of the last message sent
    double sent_s = 0.0;
  };

  void on_open() override;
  void on_text(const std::string& text) override;
  Work next_work() override;
  void on_made(std::uint64_t version) override;
  [[nodiscard]] std::string refusal(const std::string& sentence,
                                    std::string_view what) const override;
  void subscribe(const Json& message);
  void unsubscribe(const Json& message);
  [[nodiscard]] std::uint64_t version_of(const FoxgloveTopic& topic) const;
  [[nodiscard]] bool is_due(const Subscription& subscription) const;

  std::map<std::uint32_t, Subscription> subscriptions_;
  std::uint64_t messages_sent_ = 0;
  std::optional<std::uint32_t> frames_of_;  // subscription of the message being made or sent
};

}  // namespace topogeo::web
