// The robots for which peers may write.
#pragma once

namespace topogeo::messaging {

/// Does nothing; whoever calls it gets what writer_permissions.cpp notes linked in.
void note_writer_permissions();

}  // namespace topogeo::messaging
