// Limits for files from other people and programs, which bound the work and the memory for any
// content. All readers of foreign files use these limits.
//
// The limits allow a floor of some 100 m x 100 m in every format; a reader refuses larger files,
// within about 10 s and 1 GB on a small machine. Logs and recordings are read as streams and have
// no limit of length.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "topogeo/support/file_descriptor.hpp"

namespace topogeo::support {

inline constexpr std::uint64_t kMostMapBytes = 2'000'000'000;  ///< of map.pb, as in Protobuf
inline constexpr std::uint64_t kMostTextBytes = 64'000'000;  ///< of JSON, and of tables of numbers
inline constexpr std::uint64_t kMostXmlBytes = 32'000'000;   ///< a node takes more memory
inline constexpr std::uint64_t kMostYamlBytes = 16'000'000;
inline constexpr std::uint64_t kMostImageBytes = 100'000'000;
inline constexpr std::uint64_t kMostPixels = 16'000'000;  ///< 200 m x 200 m of pixels of 5 cm

/// Nested lists and objects in JSON, YAML and XML.
inline constexpr std::size_t kMostLevels = 100;
/// Keys of one JSON object: an ordered one is searched from the start for each key.
inline constexpr std::size_t kMostKeys = 128;
/// Values of a JSON text, keys included.
inline constexpr std::size_t kMostValues = 4'000'000;
/// Values of a YAML text; an alias counts with all its content.
inline constexpr std::size_t kMostYamlValues = 1'000'000;
/// Nodes and edges of an XML text.
inline constexpr std::size_t kMostXmlElements = 200'000;

/// Opens a regular file for reading. Never blocks: a FIFO has no end and a device may have none.
/// Throws std::runtime_error "PATH: is a FIFO, expected a regular file" or with the cause.
[[nodiscard]] FileDescriptor open_regular_file(const std::filesystem::path& path);

/// The content of a regular file. Throws std::runtime_error like open_regular_file(), and "PATH: is
/// N bytes, expected at most MOST" before allocating memory.
[[nodiscard]] std::string foreign_content(const std::filesystem::path& path, std::uint64_t most);

/// The first bytes of a regular file, at most `count`; empty without content.
[[nodiscard]] std::string first_bytes(const std::filesystem::path& path, std::size_t count);

/// Throws like open_regular_file() if the name belongs to something other than a regular file.
void refuse_irregular(const std::filesystem::path& path);

}  // namespace topogeo::support
