// The services of a run, and their flags.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "topogeo/supervision/process_group.hpp"

#include "run/run_options.hpp"

namespace topogeo::cli {

/// Name of the log file, the devices file or the simulated world's file.
std::string source_name(const RunOptions& options);

// Limits of a simulated base.
inline constexpr std::uint32_t kSimulatedBaseBaud = 38'400;
inline constexpr double kSimulatedTurn_rad_s = 2.0;
inline constexpr double kSimulatedAcceleration = 1.5;  // m/s^2
/// Port of "laser" or "base" that the simulator of a run creates.
std::filesystem::path simulated_port(const RunOptions& options, const std::string& device);

/// The operator's stop, which the web service of a run saves.
inline constexpr const char* kWebMemory = "stop";
/// File in which a service of a run saves the state for its restart: "odometry" of the gateway,
/// "pose" of the localizer, "goal" of the navigator, kWebMemory of the page. In memory, because a
/// write to a disk may take seconds. The caller removes it at the end.
std::filesystem::path memory_of_run(const std::string& partition, const std::string& what);
/// All existing files of the run, including those that services choose themselves.
std::vector<std::filesystem::path> memories_of_run(const std::string& partition);

/// Whether the scans come from a ROS robot.
bool from_ros(const RunOptions& options);

/// Number of scan readers that the gateway of a run waits for, with a recorder or without.
int readers_of_scans(const RunOptions& options, bool recorder);

/// The service that publishes scans: it must be asked to end before all others.
std::string scan_source(const RunOptions& options);

/// Flags common to all services of a run.
std::vector<std::string> common_arguments(const RunOptions& options, const std::string& partition);

/// Process that writes a recording.
inline constexpr const char* kRecorder = "record";

/// Starts all services in the given partition, the source of the scans last. Throws
/// std::runtime_error when a service cannot be started.
void start_services(supervision::ProcessGroup& processes, const RunOptions& options,
                    const std::string& partition);

/// Sorts by the order in which services process a scan.
std::vector<support::StageTime> by_stage(std::vector<support::StageTime> times);

}  // namespace topogeo::cli
