// Takes an operator's stop of a base that reports none: the navigator then stands by itself.
#pragma once

#include <filesystem>
#include <functional>

#include "topogeo/messaging/events.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/navigation/navigator.hpp"
#include "topogeo/service/operator_stop.hpp"
#include "topogeo/service/service.hpp"

namespace topogeo::navigator {

/// Lives in the loop of its service.
class OperatorStopInput {
 public:
  /// Keeps the stop in the file `memory` (empty: none), and passes it to the navigator, which must
  /// outlive this object. `on_change` is called when a stop has begun or ended. Throws like
  /// service::OperatorStop.
  OperatorStopInput(service::Service& service, const std::filesystem::path& memory,
                    navigation::Navigator& navigator, std::function<void()> on_change);
  OperatorStopInput(const OperatorStopInput&) = delete;
  OperatorStopInput& operator=(const OperatorStopInput&) = delete;

  /// Takes each status of the base: one that holds itself needs no other stop.
  void take(const msg::BaseStatus& status);
  /// Passes the stop to a navigator that has begun anew.
  void apply() { navigator_.set_stopped(stop_.holds()); }

 private:
  void take(const msg::BaseCommand& command, const messaging::Handle& writer);
  void change();

  service::OperatorStop stop_;
  navigation::Navigator& navigator_;
  std::function<void()> on_change_;
};

}  // namespace topogeo::navigator
