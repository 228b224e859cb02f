// Fast DDS 2.9 has no setting for this in the QoS of a writer (RTPSWriter.h has it, for whoever
// uses the RTPS layer alone); its writers can be found by their identity.
#include "separate_sending.hpp"

#include <fastdds/rtps/writer/RTPSWriter.h>
#include <fastrtps/config.h>

#include "library_function.hpp"

namespace topogeo::messaging {

namespace rtps = eprosima::fastrtps::rtps;

void send_heartbeats_to_addressees(const eprosima::fastdds::dds::DataWriter& writer) {
#if FASTRTPS_VERSION_MAJOR == 2 && FASTRTPS_VERSION_MINOR == 9
  // RTPSDomainImpl::find_local_writer; later versions return something else.
  using Find = rtps::RTPSWriter* (*)(const rtps::GUID_t&);
  static const auto find = library_function<Find>(
      "_ZN8eprosima8fastrtps4rtps14RTPSDomainImpl17find_local_writerERKNS1_6GUID_tE");
  if (find == nullptr) return;
  if (rtps::RTPSWriter* const found = find(writer.guid())) found->set_separate_sending(true);
#endif
}

}  // namespace topogeo::messaging
