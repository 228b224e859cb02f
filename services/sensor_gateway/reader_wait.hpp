// Waits until the programs that need a gateway's messages from the first one on are connected.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "topogeo/messaging/connected_programs.hpp"
#include "topogeo/messaging/event_loop.hpp"

namespace topogeo::sensor_gateway {

/// Lives in the loop.
class ReaderWait {
 public:
  struct Wanted {
    std::string topic;  ///< for people
    int programs = 0;   ///< that read it
    messaging::ConnectedPrograms connected;
  };
  /// Gets the text of the wait, for people, whenever it changes.
  using Report = std::function<void(const std::string& what)>;

  ReaderWait(messaging::EventLoop& loop, std::vector<Wanted> wanted);

  /// Calls `on_complete` once: before this returns where all are connected already.
  void start(Report report, std::function<void()> on_complete);

 private:
  void check();
  /// Empty when it has all.
  [[nodiscard]] std::string missing() const;

  messaging::EventLoop& loop_;
  std::vector<Wanted> wanted_;
  Report report_;
  std::function<void()> on_complete_;
  std::string reported_;
};

}  // namespace topogeo::sensor_gateway
