// Name of a worker, for users and on the wire.
#pragma once

#include <cstddef>
#include <string>

namespace topogeo::search_pool {

inline constexpr std::size_t kLongestName = 24;  ///< bytes, status.idl

/// The host's name, adapted to check_name.
std::string default_name();

/// Explains to a user why a name is not allowed; empty if it is. Allowed are 1 to 24 bytes without
/// blanks, quotes, '%', '#' and control characters.
std::string check_name(const std::string& name);

/// "<name>#<16 hexadecimal digits>" with digits unique to this process, so that two workers with
/// one name (containers of one image have the same process ids, too) are distinct. Throws
/// std::invalid_argument for a name that is not allowed.
std::string make_worker_id(const std::string& name);

}  // namespace topogeo::search_pool
