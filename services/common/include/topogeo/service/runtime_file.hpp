// Files in which a service keeps state for its next run.
#pragma once

#include <filesystem>
#include <string_view>

#include "topogeo/service/service_options.hpp"

namespace topogeo::service {

/// File of a service: in the runtime directory that systemd provides, else in memory (/dev/shm),
/// where `topogeo run` removes the files of its partition. `ending` begins with a dot.
std::filesystem::path runtime_file(const Setup& setup, std::string_view ending);

}  // namespace topogeo::service
