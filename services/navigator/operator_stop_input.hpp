// Obeys an operator's stop for a base that reports no stop: the navigator itself holds the robot.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "topogeo/messaging/events.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/navigation/navigator.hpp"
#include "topogeo/service/operator_stop.hpp"
#include "topogeo/service/service.hpp"

#include "stop_wait.hpp"

namespace topogeo::navigator {

/// Lives in the loop of its service.
class OperatorStopInput {
 public:
  /// Stores the stop in the file `memory` (empty: none) and passes it to the navigator, which must
  /// outlive this object. The navigator holds the robot after `start_ns` of the steady clock until
  /// a stop can no longer have been missed (StopWait). `on_change` is called when a message has
  /// begun or ended a reason to hold. Throws like service::OperatorStop.
  OperatorStopInput(service::Service& service, const std::filesystem::path& memory,
                    navigation::Navigator& navigator, std::int64_t start_ns,
                    std::function<void()> on_change);
  OperatorStopInput(const OperatorStopInput&) = delete;
  OperatorStopInput& operator=(const OperatorStopInput&) = delete;

  /// Reads a status of the base: a base that reports stops holds itself and needs no other stop.
  void take(const msg::BaseStatus& status);
  /// Ends the wait for a missed stop if its time is over at `now_ns` of the steady clock.
  void check(std::int64_t now_ns);
  /// Passes the stop to a navigator that was restarted.
  void apply() { navigator_.set_stopped(reason()); }
  /// The reason why the navigator holds the robot; empty if it does not.
  [[nodiscard]] std::string reason() const;

 private:
  void take(const msg::BaseCommand& command, const messaging::Handle& writer);
  void change();

  service::OperatorStop stop_;
  StopWait wait_;
  navigation::Navigator& navigator_;
  std::function<void()> on_change_;
};

}  // namespace topogeo::navigator
