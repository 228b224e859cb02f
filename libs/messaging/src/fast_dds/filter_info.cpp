// Keeps what filters said out of messages. Takes the place of a function of Fast DDS 2.9.1, which
// calls it through its symbol; should a library have no such function, nothing calls the one here.
//
// A writer that filters for its readers tells in each message what the filter of every one of them
// says: 16 bytes a reader. With some fifty workers that is more than fits beside a message into a
// packet, and the writer tries to send it again for ever ("Cannot add DATA submsg to the
// CDRMessage. Buffer too small"). It has sent the message to the addressee alone anyway, who
// filters it again when nothing is said.
#include "filter_info.hpp"

#include <chrono>

#include <fastdds/rtps/common/CacheChange.h>
#include <fastdds/rtps/writer/StatefulWriter.h>

#include "library_function.hpp"
#include "separate_sending.hpp"

namespace {

namespace rtps = eprosima::fastrtps::rtps;
using Deadline = std::chrono::time_point<std::chrono::steady_clock>;

constexpr const char* kSend =
    "_ZN8eprosima8fastrtps4rtps14StatefulWriter30unsent_change_added_to_historyEPNS1_13CacheChange_"
    "tERKNSt6chrono10time_pointINS5_3_V212steady_clockENS5_8durationIlSt5ratioILl1ELl1000000000EEEE"
    "EE";

}  // namespace

// NOLINTNEXTLINE: the name of a member function of the library
extern "C" void
topogeo_send_change(rtps::StatefulWriter* writer, rtps::CacheChange_t* change, const Deadline& until) __asm__(
    "_ZN8eprosima8fastrtps4rtps14StatefulWriter30unsent_change_added_to_historyEPNS1_13CacheChange_"
    "tERKNSt6chrono10time_pointINS5_3_V212steady_clockENS5_8durationIlSt5ratioILl1ELl1000000000EEEE"
    "EE");

extern "C" void topogeo_send_change(rtps::StatefulWriter* writer, rtps::CacheChange_t* change,
                                    const Deadline& until) {
  using Function = void (*)(rtps::StatefulWriter*, rtps::CacheChange_t*, const Deadline&);
  static const auto original = topogeo::messaging::library_function<Function>(kSend);
  change->inline_qos.length = 0;  // nothing else is in it
  const topogeo::messaging::SendingScope scope(*writer);
  original(writer, change, until);
}

namespace topogeo::messaging {

void keep_filter_info_out() {}

}  // namespace topogeo::messaging
