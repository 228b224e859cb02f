// Fast DDS 2.9 has no setting for this in the QoS of a writer (RTPSWriter.h has it, for whoever
// uses the RTPS layer alone); its writers can be found by their identity. The functions here take
// the place of some of the library, which calls them through their symbols; should a library have
// none of these names, nothing calls those here.
#include "separate_sending.hpp"

#include <chrono>
#include <cstdint>
#include <utility>
#include <vector>

#include <fastdds/rtps/common/CacheChange.h>
#include <fastdds/rtps/messages/RTPSMessageGroup.h>
#include <fastdds/rtps/writer/ReaderProxy.h>
#include <fastrtps/config.h>

#include "acknowledgment_pace.hpp"
#include "fragments.hpp"
#include "library_function.hpp"

namespace {

namespace messaging = topogeo::messaging;
namespace rtps = eprosima::fastrtps::rtps;

/// Of a stream of messages, as of tasks to a worker that does nothing else.
constexpr std::chrono::milliseconds kStreamPause{5};
/// Messages that have come are kept as long, at most 128 for a worker (task_writer).
constexpr std::chrono::milliseconds kAcknowledgmentPeriod{10};

constexpr const char* kMarkSent =
    "_ZN8eprosima8fastrtps4rtps11ReaderProxy21from_unsent_to_statusERKNS1_16SequenceNumber_tENS1_"
    "23ChangeForReaderStatus_tEbb";
constexpr const char* kAddHeartbeat =
    "_ZN8eprosima8fastrtps4rtps16RTPSMessageGroup13add_heartbeatERKNS1_16SequenceNumber_tES5_jbb";
constexpr const char* kAddGap =
    "_ZN8eprosima8fastrtps4rtps16RTPSMessageGroup7add_gapERKNS1_16SequenceNumber_tERKNS0_"
    "11BitmapRangeIS3_NS1_18SequenceNumberDiffELj256EEERKNS1_6GUID_tE";
constexpr const char* kAddData =
    "_ZN8eprosima8fastrtps4rtps16RTPSMessageGroup8add_dataERKNS1_13CacheChange_tEb";
constexpr const char* kAddFragment =
    "_ZN8eprosima8fastrtps4rtps16RTPSMessageGroup13add_data_fragERKNS1_13CacheChange_tEjb";

using AddGap = bool (*)(rtps::RTPSMessageGroup*, const rtps::SequenceNumber_t&,
                        const rtps::SequenceNumberSet_t&, const rtps::GUID_t&);

/// Numbers of messages that a reader does not get.
struct HeldGap {
  rtps::SequenceNumber_t first;
  rtps::SequenceNumberSet_t rest;
  rtps::GUID_t reader;
};

/// The message that this thread sends.
struct Addressed {
  bool sending = false;
  const rtps::ReaderProxy* to = nullptr;  // as soon as it was given to it
  bool gap_held = false;                  // a heartbeat follows, which would be its own packet
  std::vector<HeldGap> gaps;              // to go with the message
};
thread_local Addressed t_addressed;

messaging::AcknowledgmentPace& pace() {
  static messaging::AcknowledgmentPace of_process(kStreamPause, kAcknowledgmentPeriod);
  return of_process;
}

AddGap original_add_gap() {
  static const auto original = messaging::library_function<AddGap>(kAddGap);
  return original;
}

/// Should one go to another reader than its own, that one asks for what it lacks.
void add_held_gaps(rtps::RTPSMessageGroup* group) {
  for (const HeldGap& gap : t_addressed.gaps) {
    original_add_gap()(group, gap.first, gap.rest, gap.reader);
  }
  t_addressed.gaps.clear();
}

}  // namespace

// NOLINTBEGIN: the names of member functions of the library
extern "C" void
topogeo_mark_sent(rtps::ReaderProxy* reader, const rtps::SequenceNumber_t& number, rtps::ChangeForReaderStatus_t status, bool restart_suppression, bool delivered) __asm__(
    "_ZN8eprosima8fastrtps4rtps11ReaderProxy21from_unsent_to_statusERKNS1_16SequenceNumber_tENS1_"
    "23ChangeForReaderStatus_tEbb");
extern "C" bool
topogeo_add_heartbeat(rtps::RTPSMessageGroup* group, const rtps::SequenceNumber_t& first, const rtps::SequenceNumber_t& last, rtps::Count_t count, bool final, bool liveliness) __asm__(
    "_ZN8eprosima8fastrtps4rtps16RTPSMessageGroup13add_heartbeatERKNS1_16SequenceNumber_tES5_jbb");
extern "C" bool
topogeo_add_gap(rtps::RTPSMessageGroup* group, const rtps::SequenceNumber_t& first, const rtps::SequenceNumberSet_t& rest, const rtps::GUID_t& reader) __asm__(
    "_ZN8eprosima8fastrtps4rtps16RTPSMessageGroup7add_gapERKNS1_16SequenceNumber_tERKNS0_"
    "11BitmapRangeIS3_NS1_18SequenceNumberDiffELj256EEERKNS1_6GUID_tE");
extern "C" bool
topogeo_add_data(rtps::RTPSMessageGroup* group, const rtps::CacheChange_t& change, bool inline_qos) __asm__(
    "_ZN8eprosima8fastrtps4rtps16RTPSMessageGroup8add_dataERKNS1_13CacheChange_tEb");
extern "C" bool
topogeo_add_fragment(rtps::RTPSMessageGroup* group, const rtps::CacheChange_t& change, std::uint32_t fragment, bool inline_qos) __asm__(
    "_ZN8eprosima8fastrtps4rtps16RTPSMessageGroup13add_data_fragERKNS1_13CacheChange_tEjb");
// NOLINTEND

/// After each message of an addressed writer, a timer of 0 ns let its reader ask for it again: a
/// wake-up of another thread for what is done here at once.
extern "C" void topogeo_mark_sent(rtps::ReaderProxy* reader, const rtps::SequenceNumber_t& number,
                                  rtps::ChangeForReaderStatus_t status, bool restart_suppression,
                                  bool delivered) {
  using Function = void (*)(rtps::ReaderProxy*, const rtps::SequenceNumber_t&,
                            rtps::ChangeForReaderStatus_t, bool, bool);
  static const auto original = messaging::library_function<Function>(kMarkSent);
  if (!t_addressed.sending) {
    original(reader, number, status, restart_suppression, delivered);
    return;
  }
  original(reader, number, status, false, delivered);
  reader->perform_nack_supression();
  t_addressed.to = reader;
}

extern "C" bool topogeo_add_heartbeat(rtps::RTPSMessageGroup* group,
                                      const rtps::SequenceNumber_t& first,
                                      const rtps::SequenceNumber_t& last, rtps::Count_t count,
                                      bool final, bool liveliness) {
  using Function = bool (*)(rtps::RTPSMessageGroup*, const rtps::SequenceNumber_t&,
                            const rtps::SequenceNumber_t&, rtps::Count_t, bool, bool);
  static const auto original = messaging::library_function<Function>(kAddHeartbeat);
  if (std::exchange(t_addressed.gap_held, false)) return true;
  // A final heartbeat is answered only by a reader that lacks something. To nobody: of a message
  // whose last fragment is not sent yet.
  const bool only_reports =
      t_addressed.sending &&
      (t_addressed.to == nullptr || !pace().due(t_addressed.to, std::chrono::steady_clock::now()));
  return original(group, first, last, count, final || only_reports, liveliness);
}

extern "C" bool topogeo_add_gap(rtps::RTPSMessageGroup* group, const rtps::SequenceNumber_t& first,
                                const rtps::SequenceNumberSet_t& rest, const rtps::GUID_t& reader) {
  if (!t_addressed.sending) return original_add_gap()(group, first, rest, reader);
  t_addressed.gaps.push_back({first, rest, reader});
  t_addressed.gap_held = true;
  return true;
}

extern "C" bool topogeo_add_data(rtps::RTPSMessageGroup* group, const rtps::CacheChange_t& change,
                                 bool inline_qos) {
  using Function = bool (*)(rtps::RTPSMessageGroup*, const rtps::CacheChange_t&, bool);
  static const auto original = messaging::library_function<Function>(kAddData);
  add_held_gaps(group);
  return original(group, change, inline_qos);
}

extern "C" bool topogeo_add_fragment(rtps::RTPSMessageGroup* group,
                                     const rtps::CacheChange_t& change, std::uint32_t fragment,
                                     bool inline_qos) {
  using Function =
      bool (*)(rtps::RTPSMessageGroup*, const rtps::CacheChange_t&, std::uint32_t, bool);
  static const auto original = messaging::library_function<Function>(kAddFragment);
  add_held_gaps(group);
  const bool added = original(group, change, fragment, inline_qos);
  if (added) messaging::send_if_alone(*group, change);
  return added;
}

namespace topogeo::messaging {

SendingScope::SendingScope(const rtps::RTPSWriter& writer) {
  t_addressed.sending = writer.get_separate_sending();
}

SendingScope::~SendingScope() {
  t_addressed.sending = false;
  t_addressed.to = nullptr;
  t_addressed.gap_held = false;
  t_addressed.gaps.clear();
}

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
