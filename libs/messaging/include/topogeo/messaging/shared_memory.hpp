// Removes the shared memory that killed programs leave behind.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace topogeo::messaging {

/// Folder of the shared memory of Fast DDS.
inline constexpr const char* kSharedMemoryFolder = "/dev/shm";

/// A segment that no process writes any more, and its size.
struct DeadSegment {
  std::filesystem::path file;
  std::uintmax_t bytes = 0;
};

/// The segments that remove_dead_segments() would remove.
std::vector<DeadSegment> find_dead_segments(
    const std::filesystem::path& folder = kSharedMemoryFolder,
    std::chrono::seconds age = std::chrono::seconds(10));

/// Removes the segments of Fast DDS that no process writes any more. Each has a lock file beside it
/// that its program keeps locked until it ends. A killed program leaves 4 MB, so fifteen of them
/// fill a container of 64 MB. Files younger than `age` stay, because a starting program makes the
/// file before it locks it. Ports also stay: Fast DDS takes them over by itself. Returns the number
/// of removed segments; a segment that cannot be removed stays.
std::size_t remove_dead_segments(const std::filesystem::path& folder = kSharedMemoryFolder,
                                 std::chrono::seconds age = std::chrono::seconds(10));

}  // namespace topogeo::messaging
