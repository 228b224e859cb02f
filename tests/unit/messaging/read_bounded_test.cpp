// Reading a sequence that claims more elements than its bound permits.
#include "topogeo/msg/read_bounded.h"

#include <cstring>
#include <vector>

#include <fastdds/dds/topic/TypeSupport.hpp>
#include <gtest/gtest.h>

#include "topogeo/messaging/detail/type_support.hpp"
#include "topogeo/messaging/topics.hpp"
#include "topogeo/msg/types.h"

#include "bounds.hpp"

namespace topogeo::messaging {
namespace {

namespace cdr = eprosima::fastcdr;

/// The number of elements, then a hundred bytes.
std::vector<char> sequence_of(std::uint32_t count) {
  std::vector<char> bytes(104, 0);
  std::memcpy(bytes.data(), &count, sizeof count);
  return bytes;
}

std::vector<msg::LocalNode> read(std::uint32_t count, std::uint32_t bound) {
  std::vector<char> bytes = sequence_of(count);
  cdr::FastBuffer buffer(bytes.data(), bytes.size());
#if TOPOGEO_FAST_DDS == 2
  cdr::Cdr stream(buffer);
#else
  cdr::Cdr stream(buffer, cdr::Cdr::DEFAULT_ENDIAN, cdr::CdrVersion::XCDRv1);
#endif
  std::vector<msg::LocalNode> nodes;
  try {
    msg::read_bounded(stream, nodes, bound);
  } catch (const cdr::exception::NotEnoughMemoryException&) {
    EXPECT_EQ(nodes.capacity(), 0U) << "room is made for what is refused";
    throw;
  }
  return nodes;
}

TEST(ReadBounded, ReadsUpToTheBound) {
  EXPECT_EQ(read(0, 2).size(), 0U);
  EXPECT_EQ(read(2, 2).size(), 2U);
}

TEST(ReadBounded, MakesNoRoomForMore) {
  EXPECT_THROW(read(3, 2), cdr::exception::NotEnoughMemoryException);
  EXPECT_THROW(read(90, 2), cdr::exception::NotEnoughMemoryException);
  EXPECT_THROW(read(0xFFFFFFFF, 2), cdr::exception::NotEnoughMemoryException);
}

TEST(ReadBounded, IsWhatReadersOfTopicsDo) {
  const TopicInfo& topic = TopicTraits<msg::LocalMap>::info();
  eprosima::fastdds::dds::TypeSupport type(topic.make_type());
  for (const std::size_t nodes : {msg::kMaxLocalNodes, msg::kMaxLocalNodes + 1}) {
    msg::LocalMap message;
    message.schema_version(msg::kSchemaVersion);
    message.nodes().resize(nodes);
    Payload payload(detail::payload_size(type, &message));
    ASSERT_TRUE(detail::write_payload(type, &message, payload));
    msg::LocalMap arrived;
    ASSERT_TRUE(detail::read_payload(type, payload, &arrived));
    const bool allowed = nodes == msg::kMaxLocalNodes;
    EXPECT_EQ(arrived.schema_version(), allowed ? msg::kSchemaVersion : kUnreadable);
    EXPECT_EQ(arrived.nodes().capacity(), allowed ? nodes : 0U);
  }
}

}  // namespace
}  // namespace topogeo::messaging
