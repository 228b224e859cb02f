// Limits of files that other people and programs made: whatever such a file holds, the work and the
// memory that it makes are bounded. All readers of foreign files take their limits from here.
//
// The limits leave room for a floor of some 100 m x 100 m in every format; a reader refuses what is
// beyond, within about 10 s and 1 GB on a small machine. Logs and recordings are read as streams
// and have no limit of their length.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "topogeo/support/file_descriptor.hpp"

namespace topogeo::support {

inline constexpr std::uint64_t kMostMapBytes = 2'000'000'000;  ///< of map.pb, as Protobuf has it
inline constexpr std::uint64_t kMostTextBytes = 64'000'000;  ///< of JSON, and of tables of numbers
inline constexpr std::uint64_t kMostXmlBytes = 32'000'000;   ///< a node takes more memory
inline constexpr std::uint64_t kMostYamlBytes = 16'000'000;
inline constexpr std::uint64_t kMostImageBytes = 100'000'000;
inline constexpr std::uint64_t kMostPixels = 16'000'000;  ///< 200 m x 200 m of pixels of 5 cm

/// Lists and objects inside each other, of JSON, YAML and XML.
inline constexpr std::size_t kMostLevels = 100;
/// Keys of one JSON object: an ordered one is searched from its beginning for each of its keys.
inline constexpr std::size_t kMostKeys = 128;
/// Values of a JSON text, keys included.
inline constexpr std::size_t kMostValues = 4'000'000;
/// Values of a YAML text; an alias counts as all that it stands for.
inline constexpr std::size_t kMostYamlValues = 1'000'000;
/// Nodes and edges of an XML text.
inline constexpr std::size_t kMostXmlElements = 200'000;

/// A regular file, open for reading. Never waits: a FIFO has no end and a device may have none.
/// Throws std::runtime_error "PATH: is a FIFO, expected a regular file" or with the cause.
[[nodiscard]] FileDescriptor open_regular_file(const std::filesystem::path& path);

/// The content of a regular file. Throws std::runtime_error like open_regular_file(), and
/// "PATH: is N bytes, expected at most MOST" before it takes memory.
[[nodiscard]] std::string foreign_content(const std::filesystem::path& path, std::uint64_t most);

/// The first bytes of a regular file, at most `count`; empty where there is none.
[[nodiscard]] std::string first_bytes(const std::filesystem::path& path, std::size_t count);

/// Throws like open_regular_file() where something else than a regular file has that name.
void refuse_irregular(const std::filesystem::path& path);

}  // namespace topogeo::support
