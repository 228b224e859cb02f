// Security keeps a peer's writer or reader from ours where its permissions do not name the topic or
// its governance is another one. What Fast DDS 2.9.1 logs of this has the id of our endpoint, or
// that of the peer's without its name. This takes the place of the two functions that decide, which
// the library calls through their symbols, and notes whom they deny what. Should a library have no
// such functions, nothing calls these.
#include <fastdds/rtps/builtin/data/ReaderProxyData.h>
#include <fastdds/rtps/builtin/data/WriterProxyData.h>
#include <fastdds/rtps/common/Guid.h>
#include <fastdds/rtps/security/accesscontrol/EndpointSecurityAttributes.h>

#include "../security.hpp"
#include "library_function.hpp"

namespace {

namespace rtps = eprosima::fastrtps::rtps;

constexpr const char* kDiscoveredWriter =
    "_ZN8eprosima8fastrtps4rtps8security15SecurityManager17discovered_writerERKNS1_6GUID_tES6_"
    "RNS1_15WriterProxyDataERKNS2_26EndpointSecurityAttributesE";
constexpr const char* kDiscoveredReader =
    "_ZN8eprosima8fastrtps4rtps8security15SecurityManager17discovered_readerERKNS1_6GUID_tES6_"
    "RNS1_15ReaderProxyDataERKNS2_26EndpointSecurityAttributesE";

/// Lets the library decide about a peer's writer or reader and notes a denial.
template <class Data>
bool decide(const char* symbol, bool writer, void* manager, const rtps::GUID_t& ours,
            const rtps::GUID_t& peer, Data& theirs,
            const rtps::security::EndpointSecurityAttributes& attributes) {
  using Function = bool (*)(void*, const rtps::GUID_t&, const rtps::GUID_t&, Data&,
                            const rtps::security::EndpointSecurityAttributes&);
  static const auto next = topogeo::messaging::library_function<Function>(symbol);
  if (next == nullptr) return false;
  if (next(manager, ours, peer, theirs, attributes)) return true;
  topogeo::messaging::note_denial(
      {peer.guidPrefix, theirs.topicName().to_string(), writer,
       !attributes.match(theirs.security_attributes_, theirs.plugin_security_attributes_)});
  return false;
}

}  // namespace

// NOLINTNEXTLINE: the name of a member function of the library
extern "C" bool
topogeo_discovered_writer(void* manager, const rtps::GUID_t& reader, const rtps::GUID_t& peer, rtps::WriterProxyData& writer, const rtps::security::EndpointSecurityAttributes& attributes) __asm__(
    "_ZN8eprosima8fastrtps4rtps8security15SecurityManager17discovered_"
    "writerERKNS1_6GUID_tES6_RNS1_15WriterProxyDataERKNS2_"
    "26EndpointSecurityAttributesE");
// NOLINTNEXTLINE: the name of a member function of the library
extern "C" bool
topogeo_discovered_reader(void* manager, const rtps::GUID_t& writer, const rtps::GUID_t& peer, rtps::ReaderProxyData& reader, const rtps::security::EndpointSecurityAttributes& attributes) __asm__(
    "_ZN8eprosima8fastrtps4rtps8security15SecurityManager17discovered_"
    "readerERKNS1_6GUID_tES6_RNS1_15ReaderProxyDataERKNS2_"
    "26EndpointSecurityAttributesE");

extern "C" bool topogeo_discovered_writer(
    void* manager, const rtps::GUID_t& reader, const rtps::GUID_t& peer,
    rtps::WriterProxyData& writer, const rtps::security::EndpointSecurityAttributes& attributes) {
  return decide(kDiscoveredWriter, true, manager, reader, peer, writer, attributes);
}

extern "C" bool topogeo_discovered_reader(
    void* manager, const rtps::GUID_t& writer, const rtps::GUID_t& peer,
    rtps::ReaderProxyData& reader, const rtps::security::EndpointSecurityAttributes& attributes) {
  return decide(kDiscoveredReader, false, manager, writer, peer, reader, attributes);
}

namespace topogeo::messaging {

void note_denials() {}

}  // namespace topogeo::messaging
