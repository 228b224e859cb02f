// Checks for faults of a machine before any service runs on it.
#pragma once

#include <span>

#include "diagnose/doctor_report.hpp"
#include "diagnose/machine_facts.hpp"

namespace topogeo::cli {

/// Ports, multicast, route, buffers, shared memory, serial ports, disk, CPU, memory, limits.
std::span<const Check<MachineFacts>> machine_checks();

}  // namespace topogeo::cli
