// Certificates that peers of security show again and again.
#pragma once

namespace topogeo::messaging {

/// Keeps one certificate of a peer, the last that it has shown. Otherwise each time that a peer
/// which is refused tries again costs this process some 4 kB for ever, once a second.
///
/// Whoever calls it gets what handshake_certificates.cpp puts right linked in; it does nothing
/// else.
void keep_one_certificate_of_a_peer();

}  // namespace topogeo::messaging
