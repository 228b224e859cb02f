// Readers of peers that leave while a writer of the middleware sends.
#pragma once

namespace topogeo::messaging {

/// Lets a writer drop the messages that only a leaving reader still had to acknowledge after it has
/// released its locators. Otherwise a process whose reader left while it sent stood still for good.
///
/// Whoever calls it gets what reader_removal.cpp puts right linked in; it does nothing else.
void let_readers_leave_beside_sending();

}  // namespace topogeo::messaging
