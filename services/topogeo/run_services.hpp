// Which services a run has, and the flags that each gets.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "topogeo/supervision/process_group.hpp"

#include "run_options.hpp"

namespace topogeo::cli {

/// File name of the log, the devices or the simulated world.
std::string source_name(const RunOptions& options);

// What the base of a simulation is capable of.
inline constexpr std::uint32_t kSimulatedBaseBaud = 38'400;
inline constexpr double kSimulatedTurn_rad_s = 2.0;
inline constexpr double kSimulatedAcceleration = 1.5;  // m/s^2
/// Where the simulator of a run puts the port of "laser" or "base".
std::filesystem::path simulated_port(const RunOptions& options, const std::string& device);

/// Where a service of a run keeps what its next life needs: the gateway its "odometry", the
/// localizer the "pose" of the robot, the navigator its "goal". In memory, since a write to a disk
/// may take seconds. To be removed at the end.
std::filesystem::path memory_of_run(const std::string& partition, const std::string& what);
/// All files of the run that are there, those that services choose themselves included.
std::vector<std::filesystem::path> memories_of_run(const std::string& partition);

/// Whether the scans are those of a robot that speaks ROS.
bool from_ros(const RunOptions& options);

/// How many readers of scans the gateway of a run waits for, with a recorder or without.
int readers_of_scans(const RunOptions& options, bool recorder);

/// The one that scans come from: to be asked to end before all others.
std::string scan_source(const RunOptions& options);

/// Flags that all services of a run have.
std::vector<std::string> common_arguments(const RunOptions& options, const std::string& partition);

/// The one that writes a recording.
inline constexpr const char* kRecorder = "record";

/// Starts all services in the given partition, the source of the scans last. Throws
/// std::runtime_error when one cannot be started.
void start_services(supervision::ProcessGroup& processes, const RunOptions& options,
                    const std::string& partition);

/// In the order in which the services work on a scan.
std::vector<support::StageTime> by_stage(std::vector<support::StageTime> times);

}  // namespace topogeo::cli
