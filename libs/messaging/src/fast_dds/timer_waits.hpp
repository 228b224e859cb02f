// Timers of the middleware whose ends do not wait for each other.
#pragma once

namespace topogeo::messaging {

/// Lets a thread take a timer away while another timer is at work. Otherwise it waits for that one,
/// which may wait for a lock that the thread holds: when a peer ended while this process said that
/// it is alive, nothing arrived any more and the process did not end by a signal.
///
/// Whoever calls it gets what timer_waits.cpp puts right linked in; it does nothing else.
void let_timers_end_alone();

}  // namespace topogeo::messaging
