// Certificates that are revoked while a service runs.
#pragma once

namespace topogeo::messaging {

class Participant;

/// With security: whether the list of revoked certificates has changed since the start of the
/// participant or the last call that returned true. The middleware reads it at that start only.
[[nodiscard]] bool take_new_revocations(const Participant& participant);

}  // namespace topogeo::messaging
