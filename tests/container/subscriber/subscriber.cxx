// Prints the name of the first service whose status arrives: subscriber DOMAIN PARTITION.
#include <iostream>
#include <string>

#include <topogeo/messaging/participant.hpp>
#include <topogeo/messaging/reader.hpp>
#include <topogeo/msg/status.h>

int main(int, char** argv) {
  topogeo::messaging::ParticipantOptions options;
  options.domain = static_cast<std::uint32_t>(std::stoul(argv[1]));
  options.partition = argv[2];
  const topogeo::messaging::Participant participant(options);
  topogeo::messaging::Reader<topogeo::msg::ServiceStatus> reader(participant);
  bool heard = false;
  while (!heard) {
    static_cast<void>(reader.wait_for_data(std::chrono::seconds(1)));
    reader.take([&](const topogeo::msg::ServiceStatus& status, const auto& info) {
      if (info.valid && !heard) std::cout << status.service().c_str() << '\n';
      heard = heard || info.valid;
    });
  }
}
