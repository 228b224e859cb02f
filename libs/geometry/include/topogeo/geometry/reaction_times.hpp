// The times that pass between what sensors measure and a base that brakes, in one place, because
// programs rely on those of each other: what the guards count, the gateway and the base must keep.
//
//   measurement --age--> judged by a guard --kCommandDelay_s--> the base obeys
//   gateway or host freezes --kBaseWatchdog_s--> the base brakes by itself
//
// The age is not a constant: guards take it from the stamps.
#pragma once

namespace topogeo::geometry {

/// s; the base stops by itself when nothing has refreshed its watchdog for so long. It runs on with
/// its last command while gateway or host are frozen, so that every metre per second costs 0.3 m of
/// distance to obstacles. Shorter would stop it whenever a busy machine lets the gateway wait.
inline constexpr double kBaseWatchdog_s = 0.3;

/// s; from the judgement of a guard until the base obeys: 0.05 until the next command, 0.05 in DDS
/// and event loops, 0.05 on the serial line (four orders with 10 ms between them), and the motors.
inline constexpr double kCommandDelay_s = 0.2;

/// s; a motion command of navigator or page holds so long after its stamp. The base runs on so long
/// when they freeze: no longer than when the gateway does.
inline constexpr double kCommandValid_s = 0.3;
static_assert(kCommandValid_s <= kBaseWatchdog_s, "the guards count kBaseWatchdog_s only");

}  // namespace topogeo::geometry
