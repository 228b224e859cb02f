// Lets a test take part as a participant beside the programs that it starts.
#pragma once

#include <cstdint>
#include <string>

#include "topogeo/messaging/participant.hpp"

namespace topogeo::test {

inline messaging::Participant join(const std::string& domain, const std::string& partition) {
  messaging::ParticipantOptions options;
  options.domain = static_cast<std::uint32_t>(std::stoul(domain));
  options.partition = partition;
  return messaging::Participant(options);
}

}  // namespace topogeo::test
