// Delays between the measurement of a sensor and the reaction of a braking base, in one place,
// because programs rely on each other's: guards assume them, gateway and base must meet them.
//
//   measurement --age--> judged by a guard --kCommandDelay_s--> the base obeys
//   gateway or host freezes --kBaseWatchdog_s--> the base brakes by itself
//
// The age is not a constant: guards compute it from the stamps.
#pragma once

namespace topogeo::geometry {

/// s; the base stops by itself when its watchdog has not been refreshed for this time. While
/// gateway or host are frozen it continues its last command, so every metre per second costs 0.3 m
/// of distance to obstacles. A shorter time would stop it whenever a busy machine delays the
/// gateway.
inline constexpr double kBaseWatchdog_s = 0.3;

/// s; from the judgement of a guard until the base obeys: 0.05 until the next command, 0.05 in DDS
/// and event loops, 0.05 on the serial line (four orders with 10 ms between them), and the motors.
inline constexpr double kCommandDelay_s = 0.2;

/// s; validity of a motion command of navigator or page after its stamp. If these freeze, the base
/// continues for this time: no longer than if the gateway freezes.
inline constexpr double kCommandValid_s = 0.3;
static_assert(kCommandValid_s <= kBaseWatchdog_s, "the guards count kBaseWatchdog_s only");

}  // namespace topogeo::geometry
