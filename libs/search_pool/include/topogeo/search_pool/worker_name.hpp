// What a worker is called, by people and on the wire.
#pragma once

#include <cstddef>
#include <string>

namespace topogeo::search_pool {

inline constexpr std::size_t kLongestName = 24;  ///< bytes, status.idl

/// The host's name, fitted to what check_name allows.
std::string default_name();

/// Why a name is not allowed, for people; empty for one that is. Allowed are 1 to 24 bytes without
/// blanks, quotes, '%', '#' and control characters.
std::string check_name(const std::string& name);

/// "<name>#<16 hexadecimal digits>" with digits that no other process has, so that two workers of
/// one name (containers of one image have the same process ids, too) are two workers. Throws
/// std::invalid_argument for a name that is not allowed.
std::string make_worker_id(const std::string& name);

}  // namespace topogeo::search_pool
