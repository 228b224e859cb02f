// Files in which a service keeps state for its next run.
#pragma once

#include <filesystem>
#include <string_view>

#include "topogeo/service/service_options.hpp"

namespace topogeo::service {

/// File of a service: in the runtime directory that systemd provides, else in memory (/dev/shm),
/// where `topogeo run` removes the files of its partition. `ending` begins with a dot.
std::filesystem::path runtime_file(const Setup& setup, std::string_view ending);

/// The same with the number of the user, because users cannot write each other's files in /dev/shm.
/// The file then exists, and no other user can read it. Empty, with a warning in the log, if it
/// cannot be created or written, is no regular file or belongs to another user. `loss`: the
/// consequence, for the warning.
std::filesystem::path own_runtime_file(const Setup& setup, std::string_view ending,
                                       std::string_view loss);

}  // namespace topogeo::service
