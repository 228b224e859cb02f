// Fast DDS 2.9.1 decides by a peer's signed permissions whether its writer may write a topic in its
// partitions (Permissions::check_remote_datawriter), and keeps them to itself: who gets a sample
// cannot ask for which robot the writer may write. A changed program may put any robot into its
// samples. This takes the place of the function, which the library calls through its table of
// virtual functions, and notes the partitions of each writer that it allows, before the writer is
// connected. What a writer announces without being allowed it, also later, is not noted.
//
// Should a library have no such function, nothing calls this one, and a secured reader refuses all
// samples.
#include "writer_permissions.hpp"

#include <cstdint>

#include <fastdds/rtps/builtin/data/WriterProxyData.h>
#include <fastdds/rtps/common/InstanceHandle.h>
#include <fastdds/rtps/security/common/Handle.h>
#include <fastdds/rtps/security/exceptions/SecurityException.h>

#include "../endpoint_shared.hpp"
#include "../writer_robots.hpp"
#include "library_function.hpp"

namespace {

namespace rtps = eprosima::fastrtps::rtps;

constexpr const char* kCheckWriter =
    "_ZN8eprosima8fastrtps4rtps8security11Permissions23check_remote_datawriterERKNS2_"
    "6HandleEjRKNS1_"
    "15WriterProxyDataERNS2_17SecurityExceptionE";

}  // namespace

// NOLINTNEXTLINE: the name of a member function of the library
extern "C" bool
topogeo_check_remote_datawriter(void* plugin, const rtps::security::Handle& peer, std::uint32_t domain, const rtps::WriterProxyData& writer, rtps::security::SecurityException& error) __asm__(
    "_ZN8eprosima8fastrtps4rtps8security11Permissions23check_remote_datawriterERKNS2_"
    "6HandleEjRKNS1_"
    "15WriterProxyDataERNS2_17SecurityExceptionE");

extern "C" bool topogeo_check_remote_datawriter(void* plugin, const rtps::security::Handle& peer,
                                                std::uint32_t domain,
                                                const rtps::WriterProxyData& writer,
                                                rtps::security::SecurityException& error) {
  static const auto original =
      topogeo::messaging::library_function<decltype(&topogeo_check_remote_datawriter)>(
          kCheckWriter);
  if (original == nullptr || !original(plugin, peer, domain, writer, error)) return false;
  topogeo::messaging::writer_robots().allow(
      topogeo::messaging::detail::to_handle(rtps::InstanceHandle_t(writer.guid())),
      writer.m_qos.m_partition.getNames());
  return true;
}

namespace topogeo::messaging {

void note_writer_permissions() {}

}  // namespace topogeo::messaging
