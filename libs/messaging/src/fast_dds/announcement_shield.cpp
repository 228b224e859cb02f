// Checks what authenticated peers announce encrypted, before Fast DDS 2.9.1 parses it: it takes
// memory for any count in such a list and reads a text at any address. What comes plain was checked
// before (packets/packet_filter.hpp), which does not see into envelopes.
// Each function here takes the place of one of the library, which calls it through its symbol.
// Should a library have no such function, nothing calls the one here.
#include "announcement_shield.hpp"

#include <fastdds/rtps/builtin/data/ReaderProxyData.h>
#include <fastdds/rtps/builtin/data/WriterProxyData.h>
#include <fastdds/rtps/common/CDRMessage_t.h>

#include "../packets/parameter_check.hpp"
#include "../stranger_counts.hpp"
#include "library_function.hpp"

namespace {

namespace messaging = topogeo::messaging;
namespace rtps = eprosima::fastrtps::rtps;

constexpr const char* kReadWriter =
    "_ZN8eprosima8fastrtps4rtps15WriterProxyData18readFromCDRMessageEPNS1_12CDRMessage_tERKNS1_"
    "14NetworkFactoryEb";
constexpr const char* kReadReader =
    "_ZN8eprosima8fastrtps4rtps15ReaderProxyData18readFromCDRMessageEPNS1_12CDRMessage_tERKNS1_"
    "14NetworkFactoryEb";
/// Reads what a peer announces about a reader or a writer.
template <class Data>
bool read_endpoint(const char* symbol, Data* endpoint, rtps::CDRMessage_t* message,
                   const void* network, bool shared_memory) {
  using Function = bool (*)(Data*, rtps::CDRMessage_t*, const void*, bool);
  static const auto original = messaging::library_function<Function>(symbol);
  if (messaging::check_parameters({message->buffer, message->length})) {
    return original(endpoint, message, network, shared_memory);
  }
  messaging::count_invalid_packet();
  return false;
}

}  // namespace

// NOLINTBEGIN: the names of member functions of the library
extern "C" bool
topogeo_read_writer(rtps::WriterProxyData* data, rtps::CDRMessage_t* message, const void* network, bool shared_memory) __asm__(
    "_ZN8eprosima8fastrtps4rtps15WriterProxyData18readFromCDRMessageEPNS1_12CDRMessage_tERKNS1_"
    "14NetworkFactoryEb");
extern "C" bool
topogeo_read_reader(rtps::ReaderProxyData* data, rtps::CDRMessage_t* message, const void* network, bool shared_memory) __asm__(
    "_ZN8eprosima8fastrtps4rtps15ReaderProxyData18readFromCDRMessageEPNS1_12CDRMessage_tERKNS1_"
    "14NetworkFactoryEb");
// NOLINTEND

extern "C" bool topogeo_read_writer(rtps::WriterProxyData* data, rtps::CDRMessage_t* message,
                                    const void* network, bool shared_memory) {
  return read_endpoint(kReadWriter, data, message, network, shared_memory);
}

extern "C" bool topogeo_read_reader(rtps::ReaderProxyData* data, rtps::CDRMessage_t* message,
                                    const void* network, bool shared_memory) {
  return read_endpoint(kReadReader, data, message, network, shared_memory);
}

namespace topogeo::messaging {

void check_encrypted_announcements() {}

}  // namespace topogeo::messaging
