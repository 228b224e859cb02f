// The keys that protect what peers send each other.
#pragma once

#include <cstdint>
#include <span>

namespace topogeo::messaging {

/// Whether keys that a peer sends can be read (Object Management Group, DDS Security 1.1, 9.5.2.1,
/// KeyMaterial_AES_GCM_GMAC): a kind of transformation that is known and no key of more than 32
/// bytes or beyond the end.
bool check_key_material(std::span<const std::uint8_t> bytes);

/// Keeps keys that cannot be read, and threads that change the lists of keys while another goes
/// through them, from the middleware. Otherwise a peer with a certificate could write into the
/// memory of this process, and a reader that is made while messages come could end it.
///
/// Whoever calls it gets what security_keys.cpp puts right linked in; it does nothing else.
void keep_security_keys();

}  // namespace topogeo::messaging
