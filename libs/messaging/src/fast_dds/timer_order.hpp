// Timers of the middleware put in order by the few that have worked.
#pragma once

namespace topogeo::messaging {

/// A thread begins a round through the timers that are due; forgets those of the last one.
void begin_timer_round();

/// One that has worked in this round, so that the time it works again may be another.
void note_timer_worked(const void* timer);

}  // namespace topogeo::messaging
