// Readers of the middleware that end while writers are found.
#pragma once

namespace topogeo::messaging {

/// Lets a reader whose listener was taken away have one that does nothing. Otherwise a process that
/// ended while a peer's writer was matched to its reader crashed now and then.
///
/// Whoever calls it gets what reader_end.cpp puts right linked in; it does nothing else.
void let_readers_end_beside_peers();

}  // namespace topogeo::messaging
