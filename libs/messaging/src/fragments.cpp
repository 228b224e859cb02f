// Corrections of Fast DDS 2.9.1 for large samples on networks that lose packets. Each takes the
// place of a function of the library, which calls it through its symbol. Should a library have no
// such function, nothing calls the one here.
//
// 1. Fragments fill a packet to the last byte, but neither the key and the filters that go with
// each
//    of them are counted nor the destination that a repeated one names: "Cannot add RTPS submesage
//    to the CDRMessage. Buffer too small", for ever, and a reader that lost it never gets the
//    sample.
// 2. A sample whose first fragment comes after another one has no key while it is put together, and
//    an assertion ends the process when it is whole ("update_instance_nts"; mended in Fast
//    DDS 2.13, pull request 4261). Fragments before the first one are taken for lost here; they are
//    sent again.
// 3. A sample that is replaced while a reader puts it together is reported by a gap, which leaves
// its
//    part in the history: the same assertion, or a message half of which is zeros.
// 4. A reader allocates what a fragment states as the size of the whole, up to 4 GB for one packet.
#include "fragments.hpp"

#include <cstdint>
#include <mutex>
#include <vector>

#include <dlfcn.h>
#include <fastdds/rtps/common/CacheChange.h>
#include <fastdds/rtps/history/ReaderHistory.h>
#include <fastdds/rtps/reader/StatefulReader.h>
#include <fastdds/rtps/writer/RTPSWriter.h>

namespace {

namespace rtps = eprosima::fastrtps::rtps;

constexpr const char* kFragmentSize =
    "_ZN8eprosima8fastrtps4rtps10RTPSWriter20calculateMaxDataSizeEj";
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

template <class Function>
Function next(const char* symbol) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, symbol));  // NOLINT(*-reinterpret-cast)
}

}  // namespace

// NOLINTNEXTLINE: the name of a member function of the library
extern "C" std::uint32_t topogeo_fragment_size(
    rtps::RTPSWriter* writer,
    std::uint32_t packet) __asm__("_ZN8eprosima8fastrtps4rtps10RTPSWriter20calculateMaxDataSizeEj");

extern "C" std::uint32_t topogeo_fragment_size(rtps::RTPSWriter* writer, std::uint32_t packet) {
  using Function = std::uint32_t (*)(rtps::RTPSWriter*, std::uint32_t);
  static const auto original = next<Function>(kFragmentSize);
  return original(writer, packet) - kRoom;
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
  static const auto original = next<Function>(kTakeFragments);
  if (sample_size > kMaxSample) return false;
  const std::lock_guard lock(reader->getMutex());
  rtps::CacheChange_t* begun = nullptr;
  if (first != 1 &&
      !reader->getHistory()->get_change(fragments->sequenceNumber, fragments->writerGUID, &begun)) {
    return true;
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
  static const auto original = next<Function>(kTakeGap);
  const std::lock_guard lock(reader->getMutex());
  rtps::ReaderHistory& history = *reader->getHistory();
  std::vector<rtps::CacheChange_t*> parts;
  for (auto change = history.changesBegin(); change != history.changesEnd(); ++change) {
    const rtps::SequenceNumber_t& number = (*change)->sequenceNumber;
    if ((*change)->is_fully_assembled() || (*change)->writerGUID != writer) continue;
    if ((begin <= number && number < more.base()) || more.is_set(number)) parts.push_back(*change);
  }
  for (rtps::CacheChange_t* part : parts) history.remove_change(part);
  return original(reader, writer, begin, more);
}

namespace topogeo::messaging {

void correct_fragments() {}

}  // namespace topogeo::messaging
