// A program that watches by Foxglove's WebSocket protocol, as Foxglove and Lichtblick do.
//
// It may subscribe and nothing else. Of the topics that have changed since they were last sent the
// one goes next that was sent longest ago.
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

/// That of the header Sec-WebSocket-Protocol which the service speaks; empty: none of them.
std::string foxglove_subprotocol(std::string_view offered);

/// A frame with a message: opcode 1, id of the subscription, time, payload.
std::string message_data(std::uint32_t subscription, std::int64_t time_ns,
                         std::string_view payload);

class FoxgloveViewer : public Watcher {
 public:
  using Watcher::Watcher;

 private:
  struct Subscription {
    const FoxgloveTopic* topic = nullptr;
    std::uint64_t held = 0;  // version
    std::uint64_t turn = 0;  // number of the message that was sent last
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
  std::optional<std::uint32_t> frames_of_;  // subscription of what is made or sent
};

}  // namespace topogeo::web
