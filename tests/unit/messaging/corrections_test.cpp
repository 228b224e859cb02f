// Corrections of Fast DDS 2.9.1 and their places with Fast DDS 3.
#include "corrections.hpp"

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "network_names.hpp"

namespace topogeo::messaging {
namespace {

/// The largest message that the participant sends, as set beside its transport; empty: not set.
std::string largest_message(std::uint32_t of_transport) {
  auto transport = std::make_shared<UDPv4TransportDescriptor>();
  transport->maxMessageSize = of_transport;
  eprosima::fastdds::dds::DomainParticipantQos qos;
  qos.transport().user_transports.push_back(transport);
  fit_packets(qos);
  for (const auto& property : qos.properties().properties()) {
    if (property.name() == "fastdds.max_message_size") return property.value();
  }
  return "";
}

#if TOPOGEO_FAST_DDS == 2

TEST(Corrections, LeavePacketsToTheTransport) {
  EXPECT_EQ(largest_message(1400), "");
}

TEST(Corrections, OfSecurityExist) {
  EXPECT_NO_THROW(correct_security());
}

#else

TEST(Corrections, LeaveRoomForTheKeyOfASample) {
  EXPECT_EQ(largest_message(1400), "1376");
  EXPECT_EQ(largest_message(1300), "1276");
  EXPECT_EQ(largest_message(65500), "") << "samples are sent whole";
}

TEST(Corrections, OfSecurityAreMissing) {
  EXPECT_THROW(correct_security(), std::runtime_error);
}

#endif

}  // namespace
}  // namespace topogeo::messaging
