// Whether a base has carried out an operator's command, by its status.
#pragma once

#include "topogeo/msg/motion.h"
#include "topogeo/msg/sensor.h"

namespace topogeo::service {

/// The base refuses motion commands until a reset.
inline bool holds(const msg::BaseStatus& status) {
  return status.state() == msg::kBaseHalted || status.state() == msg::kBaseEmergencyStop;
}

/// Whether a status that follows the command confirms it. A base that still moves does not confirm
/// a halt, nor does one that refuses motion commands for another reason, for example because its
/// gateway ends.
inline bool confirms(const msg::BaseStatus& status, msg::BaseCommandKind kind) {
  if (kind == msg::kBaseHalt) return holds(status) && status.stands();
  return kind != msg::kBaseReset || !holds(status);
}

/// Whether a status that follows a reset shows a later stop than the one that the reset names: the
/// gateway refuses that reset.
inline bool refuses(const msg::BaseStatus& status, const msg::BaseCommand& command) {
  return command.kind() == msg::kBaseReset && holds(status) &&
         status.stop_count() != command.stop_count();
}

}  // namespace topogeo::service
