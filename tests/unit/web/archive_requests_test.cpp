// Sending a map to a map store that connects after other readers of such pieces.
#include "history/archive_requests.hpp"

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include <gtest/gtest.h>

#include "topogeo/messaging/topics.hpp"
#include "topogeo/service/snapshot_pieces.hpp"

#include "messaging/fixture.hpp"
#include "waiting.hpp"

namespace topogeo::web {
namespace {

service::Setup web_setup(const std::string& partition) {
  service::Setup setup;
  setup.name = "web";
  setup.options.partition = partition;
  return setup;
}

class ArchiveRequestsTest : public testing::Test {
 protected:
  [[nodiscard]] bool run_until(const std::string& what, const std::function<bool()>& condition) {
    return test::wait_for(what, condition,
                          [&] { service_.loop().run_for(std::chrono::milliseconds(5)); });
  }
  [[nodiscard]] std::uint64_t pieces_sent() {
    std::uint64_t sent = 0;
    for (const messaging::Traffic& traffic : service_.loop().traffic()) {
      if (traffic.sent && traffic.topic == messaging::kSnapshotPiece) sent += traffic.messages;
    }
    return sent;
  }

  std::string partition_ = messaging::random_partition();
  service::Service service_{web_setup(partition_)};
  ArchiveRequests requests_{service_};
  messaging::Participant peers_{messaging::options_in(partition_)};
};

TEST_F(ArchiveRequestsTest, AMapReachesAStoreThatComesLate) {
  // A localizer reads pieces of snapshots, but not of a map that is imported.
  const messaging::Reader<msg::SnapshotPiece> localizer(peers_, {.addressee = "localizer-1"});
  ASSERT_TRUE(run_until("the writer of pieces", [&] { return localizer.matched() > 0; }));
  const std::string map_file(std::size_t{3} * msg::kMaxPieceBytes, 'm');
  requests_.import("floor", map_file, [](const Answer&) {});
  ASSERT_TRUE(run_until("all pieces to be sent", [&] { return pieces_sent() >= 3; }));
  messaging::Reader<msg::SnapshotPiece> store(
      peers_, {.addressee = std::string(service::kArchiveAddressee)});
  service::PieceAssembly pieces(8);
  EXPECT_TRUE(run_until("the map at the map store", [&] {
    store.take([&](const msg::SnapshotPiece& piece, const messaging::SampleInfo& info) {
      if (info.valid) pieces.add(piece);
    });
    return pieces.complete();
  }));
  EXPECT_TRUE(pieces.complete() && pieces.take() == map_file);
}

}  // namespace
}  // namespace topogeo::web
