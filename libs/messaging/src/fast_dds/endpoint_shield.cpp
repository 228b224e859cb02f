// Bounds what a packet asks of readers and writers of Fast DDS 2.9.1, where the packet alone does
// not show that it asks for too much:
// 1. A heartbeat or a gap up to a number far off makes a reader count there one by one, with its
//    lock held: for hours.
// 2. A fragment that is asked for beyond the last one makes a writer read beyond its sample.
#include "endpoint_shield.hpp"

#include <fastdds/rtps/history/WriterHistory.h>
#include <fastdds/rtps/writer/StatefulWriter.h>

#include "../stranger_counts.hpp"
#include "library_function.hpp"

namespace {

namespace messaging = topogeo::messaging;
namespace rtps = eprosima::fastrtps::rtps;

constexpr const char* kProcessHeartbeat =
    "_ZN8eprosima8fastrtps4rtps11WriterProxy17process_heartbeatEjRKNS1_16SequenceNumber_tES5_"
    "bbbRbRi";
constexpr const char* kStartAt =
    "_ZN8eprosima8fastrtps4rtps11WriterProxy19loaded_from_storageERKNS1_16SequenceNumber_tE";
constexpr const char* kCompleteUpTo =
    "_ZNK8eprosima8fastrtps4rtps11WriterProxy21available_changes_maxEv";
constexpr const char* kTakeNackFragment =
    "_ZN8eprosima8fastrtps4rtps14StatefulWriter17process_nack_fragERKNS1_6GUID_tES5_jRKNS1_"
    "16SequenceNumber_tENS0_11BitmapRangeIjNS0_12DiffFunctionIjEELj256EEERb";

std::int64_t value(const rtps::SequenceNumber_t& number) {
  return static_cast<std::int64_t>(number.to64long());
}

std::int64_t complete_up_to(const rtps::WriterProxy* writer) {
  using Function = rtps::SequenceNumber_t (*)(const rtps::WriterProxy*);
  static const auto function = messaging::library_function<Function>(kCompleteUpTo);
  return value(function(writer));
}

/// Opens what is protected in a writer: its history.
struct OpenWriter : rtps::RTPSWriter {
  static rtps::WriterHistory& history_of(rtps::RTPSWriter& writer) {
    return *(writer.*(&OpenWriter::mp_history));
  }
};

/// Whether a writer has all fragments that it is asked for.
bool has_fragments(rtps::StatefulWriter& writer, const rtps::SequenceNumber_t& number,
                   const rtps::FragmentNumberSet_t& fragments) {
  const std::lock_guard lock(writer.getMutex());
  rtps::CacheChange_t* change = nullptr;
  if (!OpenWriter::history_of(writer).get_change(number, writer.getGuid(), &change)) return false;
  const std::uint32_t count = change->getFragmentCount();
  return !fragments.empty() && fragments.min() > 0 && fragments.max() <= count;
}

}  // namespace

// NOLINTBEGIN: the names of member functions of the library
extern "C" bool
topogeo_process_heartbeat(rtps::WriterProxy* writer, std::uint32_t count, const rtps::SequenceNumber_t& first, const rtps::SequenceNumber_t& last, bool is_final, bool liveliness, bool no_positive, bool& assert_liveliness, std::int32_t& lost) __asm__(
    "_ZN8eprosima8fastrtps4rtps11WriterProxy17process_heartbeatEjRKNS1_16SequenceNumber_tES5_"
    "bbbRbRi");
extern "C" bool
topogeo_take_nack_fragment(rtps::StatefulWriter* writer, const rtps::GUID_t& addressee, const rtps::GUID_t& reader, std::uint32_t count, const rtps::SequenceNumber_t& number, rtps::FragmentNumberSet_t fragments, bool& result) __asm__(
    "_ZN8eprosima8fastrtps4rtps14StatefulWriter17process_nack_fragERKNS1_6GUID_tES5_jRKNS1_"
    "16SequenceNumber_tENS0_11BitmapRangeIjNS0_12DiffFunctionIjEELj256EEERb");
// NOLINTEND

extern "C" bool topogeo_process_heartbeat(rtps::WriterProxy* writer, std::uint32_t count,
                                          const rtps::SequenceNumber_t& first,
                                          const rtps::SequenceNumber_t& last, bool is_final,
                                          bool liveliness, bool no_positive,
                                          bool& assert_liveliness, std::int32_t& lost) {
  using Function = bool (*)(rtps::WriterProxy*, std::uint32_t, const rtps::SequenceNumber_t&,
                            const rtps::SequenceNumber_t&, bool, bool, bool, bool&, std::int32_t&);
  static const auto original = messaging::library_function<Function>(kProcessHeartbeat);
  const std::int64_t known = complete_up_to(writer);
  if (value(first) - known > messaging::kMostGone) {
    if (known != 0) {
      messaging::count_invalid_packet();
      assert_liveliness = false;
      lost = 0;
      return false;
    }
    // The first that is heard of a writer that has written for long: start there.
    using Start = void (*)(rtps::WriterProxy*, const rtps::SequenceNumber_t&);
    static const auto start_at = messaging::library_function<Start>(kStartAt);
    start_at(writer, first - 2);
  }
  return original(writer, count, first, last, is_final, liveliness, no_positive, assert_liveliness,
                  lost);
}

extern "C" bool topogeo_take_nack_fragment(rtps::StatefulWriter* writer,
                                           const rtps::GUID_t& addressee,
                                           const rtps::GUID_t& reader, std::uint32_t count,
                                           const rtps::SequenceNumber_t& number,
                                           rtps::FragmentNumberSet_t fragments, bool& result) {
  using Function =
      bool (*)(rtps::StatefulWriter*, const rtps::GUID_t&, const rtps::GUID_t&, std::uint32_t,
               const rtps::SequenceNumber_t&, const rtps::FragmentNumberSet_t, bool&);
  static const auto original = messaging::library_function<Function>(kTakeNackFragment);
  if (addressee == writer->getGuid() && !has_fragments(*writer, number, fragments)) {
    result = false;
    return true;
  }
  return original(writer, addressee, reader, count, number, fragments, result);
}

namespace topogeo::messaging {

std::int64_t complete_up_to(rtps::StatefulReader& reader, const rtps::GUID_t& writer) {
  rtps::WriterProxy* proxy = nullptr;
  return reader.matched_writer_lookup(writer, &proxy) ? ::complete_up_to(proxy) : -1;
}

}  // namespace topogeo::messaging
