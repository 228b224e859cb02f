// What a packet may ask of a reader or a writer.
#pragma once

#include <cstdint>

#include <fastdds/rtps/reader/StatefulReader.h>

namespace topogeo::messaging {

/// The last sample up to which a reader has all of a writer or has heard that they are gone; -1 for
/// a writer that it is not matched with.
[[nodiscard]] std::int64_t complete_up_to(eprosima::fastrtps::rtps::StatefulReader& reader,
                                          const eprosima::fastrtps::rtps::GUID_t& writer);

/// Samples that one message may declare gone: the reader goes through them one by one with its
/// lock held. More are heard of with the next messages.
constexpr std::int64_t kMostGone = 1 << 20;

}  // namespace topogeo::messaging
