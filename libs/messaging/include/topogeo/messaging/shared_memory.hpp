// What programs that were killed leave in shared memory.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace topogeo::messaging {

/// Where Fast DDS has its shared memory.
inline constexpr const char* kSharedMemoryFolder = "/dev/shm";

/// A segment in which nobody will write again, and its size.
struct DeadSegment {
  std::filesystem::path file;
  std::uintmax_t bytes = 0;
};

/// What remove_dead_segments() would remove.
std::vector<DeadSegment> find_dead_segments(
    const std::filesystem::path& folder = kSharedMemoryFolder,
    std::chrono::seconds age = std::chrono::seconds(10));

/// Removes the segments of Fast DDS in which nobody will write again: each has a file beside it
/// that its program keeps locked, and the kernel frees the lock of the dead. A killed program
/// leaves 4 MB, so a container of 64 MB would be full after fifteen. Files younger than `age` stay,
/// as one that starts makes the file before it locks it. Ports stay, too: Fast DDS takes them over
/// by itself. Returns how many segments were removed; what may not be removed stays.
std::size_t remove_dead_segments(const std::filesystem::path& folder = kSharedMemoryFolder,
                                 std::chrono::seconds age = std::chrono::seconds(10));

}  // namespace topogeo::messaging
