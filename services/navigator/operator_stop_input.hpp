// Takes an operator's stop of a base that reports none: the navigator then stands by itself.
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
  /// Keeps the stop in the file `memory` (empty: none), and passes it to the navigator, which must
  /// outlive this object. The navigator stands from `start_ns` of the steady clock until it can
  /// have missed no stop, see StopWait. `on_change` is called when a message has begun or ended a
  /// reason to stand. Throws like service::OperatorStop.
  OperatorStopInput(service::Service& service, const std::filesystem::path& memory,
                    navigation::Navigator& navigator, std::int64_t start_ns,
                    std::function<void()> on_change);
  OperatorStopInput(const OperatorStopInput&) = delete;
  OperatorStopInput& operator=(const OperatorStopInput&) = delete;

  /// Takes each status of the base: one that holds itself needs no other stop.
  void take(const msg::BaseStatus& status);
  /// Ends the wait for a stop once it is over at `now_ns` of the steady clock.
  void check(std::int64_t now_ns);
  /// Passes the stop to a navigator that has begun anew.
  void apply() { navigator_.set_stopped(reason()); }
  /// Why the navigator stands; empty: for no stop.
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
