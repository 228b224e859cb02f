// Readers of the middleware that end while peers come and go.
#pragma once

namespace topogeo::messaging {

/// Lets a reader whose listener was taken away have one that does nothing, and one that is told of
/// a peer's liveliness stay until then. Otherwise a process that ended while a peer's writer was
/// matched to its reader, or was found to be dead, crashed now and then.
///
/// Whoever calls it gets what reader_end.cpp puts right linked in; it does nothing else.
void let_readers_end_beside_peers();

}  // namespace topogeo::messaging
