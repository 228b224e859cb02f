// Gateway and emulated lasers on a network: scans, a cable that comes out, and the end.
#include <string>

#include "topogeo/devices/laser_models.hpp"

#include "gateway_fixture.hpp"
#include "tcp_port.hpp"

namespace topogeo::test {
namespace {

class EachNetworkLaser : public GatewayOnDevices, public testing::WithParamInterface<std::string> {
 protected:
  EachNetworkLaser() {
    simulator::TcpPort port("127.0.0.1", 0);
    port.plug();
    laser_model_ = GetParam();
    const bool datagrams = devices::sends_datagrams(devices::laser_model(laser_model_));
    laser_port_ =
        (datagrams ? "udp://127.0.0.1:" : "tcp://127.0.0.1:") + std::to_string(port.port());
  }
};

TEST_P(EachNetworkLaser, SendsScansThroughTheGatewayAlsoAfterItsCableCameOut) {
  start();
  ASSERT_FALSE(HasFatalFailure());
  EXPECT_GT(scans_.back().ranges_m().size(), 500U);
  strike(msg::kSimulatedUnplug, msg::kSimulatedLaser, 0.5);
  // The port of datagrams stays open: the driver notices the silence.
  ASSERT_TRUE(wait_for([&] {
    return counter("laser_port_opened") >= 2.0 || counter("laser_searches") >= 1.0;
  })) << gateway_->err();
  const std::size_t before = scans_.size();
  EXPECT_TRUE(wait_for([&] { return laser_is(msg::kLaserRunning) && scans_.size() > before + 5; }))
      << gateway_->err();
}

INSTANTIATE_TEST_SUITE_P(All, EachNetworkLaser,
                         testing::Values("ust_20lx", "sick_tim5xx", "sick_tim7xx",
                                         "sick_nanoscan3"),
                         [](const auto& laser) { return laser.param; });

}  // namespace
}  // namespace topogeo::test
