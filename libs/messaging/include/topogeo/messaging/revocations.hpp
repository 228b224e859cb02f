// Certificates that are revoked while a service runs.
#pragma once

namespace topogeo::messaging {

class Participant;

/// With security: whether the list of revoked certificates has changed since the participant
/// started or since the last call that returned true. The middleware reads the list at the start
/// only.
[[nodiscard]] bool take_new_revocations(const Participant& participant);

}  // namespace topogeo::messaging
