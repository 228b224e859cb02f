// The configuration and the notes of the commands.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/pipeline/config.hpp"

namespace topogeo::cli {

/// The configuration of a file, or the defaults. Throws service::UsageError if it is unusable.
pipeline::LoadedConfig load(const std::optional<std::filesystem::path>& file);
/// The same, without the sources of its values.
pipeline::Config read_config(const std::optional<std::filesystem::path>& file);

/// Prints each note as a line on stderr; many notes that are alike become one line.
void print_notes(const std::vector<std::string>& notes);

}  // namespace topogeo::cli
