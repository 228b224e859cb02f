// Partitions that belong to one program.
#pragma once

#include <string>
#include <string_view>

namespace topogeo::service {

/// A partition that no other program has: "<purpose>-<process id>-<random number>". The process id
/// shows people the owner. It does not suffice: processes of containers on one network, or with one
/// /dev/shm, have the same ids, and a later process may get the id of a dead one.
std::string own_partition(std::string_view purpose);

}  // namespace topogeo::service
