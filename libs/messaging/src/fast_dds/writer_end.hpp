// Writers of the middleware that end beside their heartbeats.
#pragma once

namespace topogeo::messaging {

/// Lets no heartbeat of a writer go through messages that are being given back as it ends.
/// Otherwise a process that ended with messages under way now and then did not end by a signal.
///
/// Whoever calls it gets what writer_end.cpp puts right linked in; it does nothing else.
void let_writers_end_undisturbed();

}  // namespace topogeo::messaging
