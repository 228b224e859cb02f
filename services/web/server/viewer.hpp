// A page that watches: a WebSocket that is brought up to date whenever it can take more.
//
// Changed channels are sent in turn: the one sent longest ago goes next, so that a slow link gets
// some of everything.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <boost/asio/steady_timer.hpp>

#include "server/transit_clock.hpp"
#include "server/viewer_message.hpp"
#include "server/watcher.hpp"

namespace topogeo::web {

class Viewer : public Watcher {
 public:
  /// Like Watcher.
  Viewer(Connection connection, ServerState& state, std::shared_ptr<void> place, bool has_token);
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;
  ~Viewer() override;

 private:
  void on_open() override;
  void on_text(const std::string& text) override;
  void on_end() override;
  Work next_work() override;
  void on_made(std::uint64_t version) override;
  [[nodiscard]] std::string refusal(const std::string& sentence,
                                    std::string_view what) const override;
  void on_message(const ViewerMessage& message);
  void hello(const ViewerMessage& message);
  void want(const ViewerMessage& message);
  void drive(const ViewerMessage& message, double late_s);
  void stop();
  void show_stop(const Answer& answer);
  [[nodiscard]] std::size_t next_channel() const;

  std::uint64_t number_;
  std::string page_;  // secret id of an operator's page
  asio::steady_timer hello_timer_;
  bool ready_ = false;  // the first message has arrived or will not
  TransitClock transit_;
  std::array<bool, kChannels> wanted_{};
  std::array<std::uint64_t, kChannels> held_{};
  std::array<bool, kChannels> anew_{};           // to be sent whole even without changes
  std::array<std::uint64_t, kChannels> sent_{};  // number of the last message sent
  std::uint64_t messages_sent_ = 0;
  std::size_t made_ = 0;  // channel of the message being made
};

}  // namespace topogeo::web
