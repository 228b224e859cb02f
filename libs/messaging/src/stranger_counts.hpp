// Adds to the counts of strangers.hpp. Thread-safe.
#pragma once

#include <cstdint>

namespace topogeo::messaging {

void count_invalid_packet();
void count_unprotected_packet();
void count_security_error();
void count_denied_sample();
void count_unknown_topic();
void count_forged_removals(std::uint64_t count);

}  // namespace topogeo::messaging
