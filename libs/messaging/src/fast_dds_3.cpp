// The place of the corrections of Fast DDS 2.9.1 for Fast DDS 3, of which no function is replaced.
#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>

#include "corrections.hpp"
#include "network_names.hpp"

#if TOPOGEO_FAST_DDS != 2

namespace topogeo::messaging {

void correct_fast_dds() {}

void fit_packets(eprosima::fastdds::dds::DomainParticipantQos& qos) {
  constexpr std::uint32_t kKey_bytes = 24;         // with the headers of the list that it is in
  constexpr std::uint32_t kWholeSamples = 60'000;  // the system cuts larger packets itself
  std::uint32_t smallest = std::numeric_limits<std::uint32_t>::max();
  for (const auto& transport : qos.transport().user_transports) {
    smallest = std::min(smallest, transport->max_message_size());
  }
  if (smallest <= kKey_bytes || smallest > kWholeSamples) return;
  qos.properties().properties().emplace_back("fastdds.max_message_size",
                                             std::to_string(smallest - kKey_bytes));
}

void correct_security() {
  throw std::runtime_error(
      "DDS security: not supported with Fast DDS 3 (Debian 13) yet; use Debian 12, or unset "
      "TOPOGEO_SECURITY in a network that only trusted programs reach");
}

void send_fragments_within(std::uint32_t /*message_bytes*/) {}

void send_heartbeats_to_addressees(const eprosima::fastdds::dds::DataWriter& /*writer*/) {}

}  // namespace topogeo::messaging

#endif
