// Files of an export as bytes, before they are written.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace topogeo::exchange {

struct OutputFile {
  std::filesystem::path path;
  std::string bytes;
};

/// Remarks on an export or import for people: parts left out, ignored or assumed.
using Notes = std::vector<std::string>;

/// Writes each file whole or not at all, in order: a file that names others comes last. Throws
/// std::runtime_error naming the file and the cause.
void write_files(std::span<const OutputFile> files);

}  // namespace topogeo::exchange
