// When Fast DDS 2.9.1 has found a writer for a reader it tells the reader's listener, and looks for
// it anew each time (EDP::pairing_remote_writer_with_local_reader_after_security and others). A
// reader that ends meanwhile has none from one look to the next. The reader itself stays until all
// is told: who removes it waits for the lock of all endpoints. Here there is always a listener. The
// function takes the place of the library's, which calls it through its symbol and does no more
// with a listener than to tell it. Should a library have no such function, nothing calls this one.
//
// No reader of ours requests a liveliness: a reader that ends while its writer's is lost would be
// told after its end (WLP::sub_liveliness_changed).
#include "reader_end.hpp"

#include <fastdds/rtps/reader/RTPSReader.h>
#include <fastdds/rtps/reader/ReaderListener.h>

#include "library_function.hpp"

namespace rtps = eprosima::fastrtps::rtps;

using topogeo::messaging::library_function;

// NOLINTNEXTLINE: the name of a member function of the library
extern "C" rtps::ReaderListener* topogeo_listener_of(const rtps::RTPSReader* reader) __asm__(
    "_ZNK8eprosima8fastrtps4rtps10RTPSReader11getListenerEv");

extern "C" rtps::ReaderListener* topogeo_listener_of(const rtps::RTPSReader* reader) {
  using Function = rtps::ReaderListener* (*)(const rtps::RTPSReader*);
  static const auto original =
      library_function<Function>("_ZNK8eprosima8fastrtps4rtps10RTPSReader11getListenerEv");
  static rtps::ReaderListener nobody;
  rtps::ReaderListener* const listener = original(reader);
  return listener == nullptr ? &nobody : listener;
}

namespace topogeo::messaging {

void let_readers_end_beside_peers() {}

}  // namespace topogeo::messaging
