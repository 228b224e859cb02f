// Waits for the programs that need a gateway's messages from the first one on.
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
    int programs = 0;   ///< number of programs that read it
    messaging::ConnectedPrograms connected;
  };
  /// Called with the text of the wait, for people, whenever it changes.
  using Report = std::function<void(const std::string& what)>;

  ReaderWait(messaging::EventLoop& loop, std::vector<Wanted> wanted);

  /// Calls `on_complete` once, before returning if all readers are already connected.
  void start(Report report, std::function<void()> on_complete);

 private:
  void check();
  /// Empty when all readers are connected.
  [[nodiscard]] std::string missing() const;

  messaging::EventLoop& loop_;
  std::vector<Wanted> wanted_;
  Report report_;
  std::function<void()> on_complete_;
  std::string reported_;
};

}  // namespace topogeo::sensor_gateway
