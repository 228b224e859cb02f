// In Fast DDS 2.9.1 a writer that ends gives its messages back before it takes its heartbeat's
// timer away, each under its lock, but all of them without it. They stay in its history meanwhile,
// with number 0. A heartbeat that gets the lock in between counts from the number of one message to
// that of the next (StatefulWriter::add_gaps_for_holes_in_history_) and, as that is less, does not
// come to an end; it has the lock, for which the writer's end waits.
//
// Here all messages are given back under the lock. The function takes the place of the library's,
// which calls it through its symbol. Should a library have no such function, nothing calls this
// one.
#include "writer_end.hpp"

#include <mutex>

#include <fastdds/rtps/writer/RTPSWriter.h>

#include "library_function.hpp"

namespace rtps = eprosima::fastrtps::rtps;

// NOLINTBEGIN: the name of a member function of the library
extern "C" void topogeo_give_messages_back(rtps::RTPSWriter* writer) __asm__(
    "_ZN8eprosima8fastrtps4rtps10RTPSWriter6deinitEv");
// NOLINTEND

extern "C" void topogeo_give_messages_back(rtps::RTPSWriter* writer) {
  static const auto original = topogeo::messaging::library_function<void (*)(rtps::RTPSWriter*)>(
      "_ZN8eprosima8fastrtps4rtps10RTPSWriter6deinitEv");
  const std::lock_guard lock(writer->getMutex());
  original(writer);
}

namespace topogeo::messaging {

void let_writers_end_undisturbed() {}

}  // namespace topogeo::messaging
