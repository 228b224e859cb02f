// Announcements of readers and writers that come encrypted.
#pragma once

namespace topogeo::messaging {

/// Does nothing; whoever calls it gets the checks linked in.
void check_encrypted_announcements();

}  // namespace topogeo::messaging
