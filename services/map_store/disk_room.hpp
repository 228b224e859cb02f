// Lets a map store that starts on a full disk wait for room, and reports it.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "topogeo/service/service_options.hpp"

namespace topogeo::map_store {

/// Whether a file of some size can be written in each of the directories, which are made if
/// missing. False on a full disk, or at a quota or file size limit; true when writing fails for
/// another reason, because waiting does not cure that.
bool have_room(std::span<const std::filesystem::path> directories);

/// Joins the domain and reports the state kServiceFailed with `why` and the fault "disk full" until
/// the directories have room (returns true) or the program is asked to end (returns false).
bool wait_for_room(const service::Setup& setup, std::span<const std::filesystem::path> directories,
                   const std::string& why);

}  // namespace topogeo::map_store
