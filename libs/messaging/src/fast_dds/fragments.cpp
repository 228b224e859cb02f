// Corrections of Fast DDS 2.9.1 for large samples on networks that lose packets. Each takes the
// place of a function of the library, which calls it through its symbol. Should a library have no
// such function, nothing calls the one here.
//
// 1. Fragments fill a packet to the last byte, but neither the key and the filters that go with
//    each of them are counted nor the destination that a repeated one names: "Cannot add RTPS
//    submesage to the CDRMessage. Buffer too small", for ever, and a reader that lost it never gets
//    the sample.
// 2. A sample whose first fragment comes after another one has no key while it is put together, and
//    an assertion ends the process when it is whole ("update_instance_nts"; mended in Fast
//    DDS 2.13, pull request 4261). Fragments before the first one are taken for lost here; they are
//    sent again.
// 3. A sample that is replaced while a reader puts it together is reported by a gap, which leaves
//    its part in the history: the same assertion, or a message half of which is zeros.
// 4. A reader allocates what a fragment states as the size of the whole, up to 4 GB for one packet.
// 5. A fragment may state another size of the whole than those before it: its bytes are read from
//    beyond the packet.
// 6. A message holds as many fragments as it has room for. Secured participants have room for 64 kB
//    in each, because of their certificates, and so large a message hardly ever arrives where
//    packets are lost.
#include "fragments.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <mutex>
#include <vector>

#include <fastdds/rtps/common/CacheChange.h>
#include <fastdds/rtps/history/ReaderHistory.h>
#include <fastdds/rtps/messages/RTPSMessageGroup.h>
#include <fastdds/rtps/reader/StatefulReader.h>
#include <fastdds/rtps/writer/RTPSWriter.h>

#include "endpoint_shield.hpp"
#include "library_function.hpp"

namespace {

namespace rtps = eprosima::fastrtps::rtps;

constexpr const char* kFragmentSize =
    "_ZN8eprosima8fastrtps4rtps10RTPSWriter20calculateMaxDataSizeEj";
constexpr const char* kSendNow = "_ZN8eprosima8fastrtps4rtps16RTPSMessageGroup15flush_and_resetEv";
constexpr const char* kTakeFragments =
    "_ZN8eprosima8fastrtps4rtps14StatefulReader18processDataFragMsgEPNS1_13CacheChange_tEjjt";
constexpr const char* kTakeGap =
    "_ZN8eprosima8fastrtps4rtps14StatefulReader13processGapMsgERKNS1_6GUID_tERKNS1_"
    "16SequenceNumber_"
    "tERKNS0_11BitmapRangeIS6_NS1_18SequenceNumberDiffELj256EEE";

/// Destination 16 bytes, key 24, filters of a reader 28, a heartbeat 32: and a third more.
constexpr std::uint32_t kRoom = 128;
/// A local map with all bounds used takes 50 MB, and nothing is larger.
constexpr std::uint32_t kMaxSample = 64U << 20U;

constexpr std::uint32_t kUnbounded = std::numeric_limits<std::uint32_t>::max();

/// What a message with a fragment of a topic of ours may take.
std::atomic<std::uint32_t> fragment_message{kUnbounded};

/// The same for this writer: those of the middleware itself are free. Object Management Group,
/// DDSI-RTPS 2.3, table 9.1.
std::uint32_t most_with_fragment(const rtps::GUID_t& writer) {
  constexpr unsigned kBuiltIn = 0xC0;
  return (writer.entityId.value[3] & kBuiltIn) == kBuiltIn ? kUnbounded : fragment_message.load();
}

/// From `begin` to the base of `more`, and what is set in `more`.
struct Gap {
  rtps::SequenceNumber_t begin;
  rtps::SequenceNumberSet_t more;
};

/// The part of a gap that a reader goes through now, which has all up to `complete`; empty when it
/// is too far from there. What is left out the writer sends again.
Gap bounded(const rtps::SequenceNumber_t& begin, const rtps::SequenceNumberSet_t& more,
            std::int64_t complete) {
  const auto first = static_cast<std::int64_t>(begin.to64long());
  const auto end = static_cast<std::int64_t>(more.base().to64long());
  const std::int64_t last_end = complete + topogeo::messaging::kMostGone;
  // What the reader knows needs no counting.
  const std::int64_t new_first = std::min(std::max(first, complete + 1), end - 1);
  const auto number = [](std::int64_t value) {
    return rtps::SequenceNumber_t(static_cast<std::uint64_t>(value));
  };
  if (first >= end || new_first >= last_end) {
    return {number(first), rtps::SequenceNumberSet_t(number(first))};
  }
  if (end > last_end) return {number(new_first), rtps::SequenceNumberSet_t(number(last_end))};
  return {number(new_first), more};
}

/// What makes fragments and gaps of a reader come one after the other. The reader's own lock must
/// not be held around the library's functions: they take that of liveliness, and give the reader's
/// away to take that of discovery. Other threads take these in the other order.
std::recursive_mutex& turn_of(const rtps::StatefulReader* reader) {
  static std::array<std::recursive_mutex, 16> turns;
  return turns[std::hash<const rtps::StatefulReader*>{}(reader) / alignof(std::max_align_t) %
               turns.size()];
}

}  // namespace

// NOLINTNEXTLINE: the name of a member function of the library
extern "C" std::uint32_t topogeo_fragment_size(
    rtps::RTPSWriter* writer,
    std::uint32_t packet) __asm__("_ZN8eprosima8fastrtps4rtps10RTPSWriter20calculateMaxDataSizeEj");

extern "C" std::uint32_t topogeo_fragment_size(rtps::RTPSWriter* writer, std::uint32_t packet) {
  using Function = std::uint32_t (*)(rtps::RTPSWriter*, std::uint32_t);
  static const auto original = topogeo::messaging::library_function<Function>(kFragmentSize);
  return original(writer, std::min(packet, most_with_fragment(writer->getGuid()))) - kRoom;
}

// NOLINTNEXTLINE: the name of a member function of the library
extern "C" bool
topogeo_take_fragments(rtps::StatefulReader* reader, rtps::CacheChange_t* fragments, std::uint32_t sample_size, std::uint32_t first, std::uint16_t count) __asm__(
    "_ZN8eprosima8fastrtps4rtps14StatefulReader18processDataFragMsgEPNS1_13CacheChange_tEjjt");

extern "C" bool topogeo_take_fragments(rtps::StatefulReader* reader, rtps::CacheChange_t* fragments,
                                       std::uint32_t sample_size, std::uint32_t first,
                                       std::uint16_t count) {
  using Function = bool (*)(rtps::StatefulReader*, rtps::CacheChange_t*, std::uint32_t,
                            std::uint32_t, std::uint16_t);
  static const auto original = topogeo::messaging::library_function<Function>(kTakeFragments);
  if (sample_size > kMaxSample) return false;
  const std::lock_guard turn(turn_of(reader));
  {
    const std::lock_guard lock(reader->getMutex());
    rtps::CacheChange_t* begun = nullptr;
    if (!reader->getHistory()->get_change(fragments->sequenceNumber, fragments->writerGUID,
                                          &begun)) {
      if (first != 1) return true;
    } else if (begun->serializedPayload.length != sample_size ||
               begun->getFragmentSize() != fragments->getFragmentSize()) {
      return false;
    }
  }
  return original(reader, fragments, sample_size, first, count);
}

// NOLINTNEXTLINE: the name of a member function of the library
extern "C" bool
topogeo_take_gap(rtps::StatefulReader* reader, const rtps::GUID_t& writer, const rtps::SequenceNumber_t& begin, const rtps::SequenceNumberSet_t& more) __asm__(
    "_ZN8eprosima8fastrtps4rtps14StatefulReader13processGapMsgERKNS1_6GUID_tERKNS1_"
    "16SequenceNumber_"
    "tERKNS0_11BitmapRangeIS6_NS1_18SequenceNumberDiffELj256EEE");

extern "C" bool topogeo_take_gap(rtps::StatefulReader* reader, const rtps::GUID_t& writer,
                                 const rtps::SequenceNumber_t& begin,
                                 const rtps::SequenceNumberSet_t& more) {
  using Function = bool (*)(rtps::StatefulReader*, const rtps::GUID_t&,
                            const rtps::SequenceNumber_t&, const rtps::SequenceNumberSet_t&);
  static const auto original = topogeo::messaging::library_function<Function>(kTakeGap);
  const std::lock_guard turn(turn_of(reader));
  Gap gap;
  {
    const std::lock_guard lock(reader->getMutex());
    gap = bounded(begin, more, topogeo::messaging::complete_up_to(*reader, writer));
    if (gap.begin == gap.more.base()) return false;
    rtps::ReaderHistory& history = *reader->getHistory();
    std::vector<rtps::CacheChange_t*> parts;
    for (auto change = history.changesBegin(); change != history.changesEnd(); ++change) {
      const rtps::SequenceNumber_t& number = (*change)->sequenceNumber;
      if ((*change)->is_fully_assembled() || (*change)->writerGUID != writer) continue;
      if ((gap.begin <= number && number < gap.more.base()) || gap.more.is_set(number)) {
        parts.push_back(*change);
      }
    }
    for (rtps::CacheChange_t* part : parts) history.remove_change(part);
  }
  return original(reader, writer, gap.begin, gap.more);
}

namespace topogeo::messaging {

void correct_fragments() {}

void send_if_alone(rtps::RTPSMessageGroup& group, const rtps::CacheChange_t& sample) {
  using Function = void (*)(rtps::RTPSMessageGroup*);
  static const auto send_now = library_function<Function>(kSendNow);
  if (most_with_fragment(sample.writerGUID) != kUnbounded) send_now(&group);
}

void send_fragments_within(std::uint32_t message_bytes) {
  fragment_message = std::min(fragment_message.load(), message_bytes);
}

}  // namespace topogeo::messaging
