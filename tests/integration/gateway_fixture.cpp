#include "gateway_fixture.hpp"

#include <fstream>

#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/topics.hpp"
#include "topogeo/support/host.hpp"

#include "join.hpp"

namespace topogeo::test {
namespace {

constexpr const char* kPartition = "gateway-test";

}  // namespace

GatewayOnDevices::GatewayOnDevices()
    : participant_(join(domain_, kPartition)),
      scans_reader_(participant_, {.role = std::string(messaging::kReplayRole),
                                   .read_with = {messaging::kOdometry}}),
      odometry_reader_(participant_),
      base_reader_(participant_),
      laser_reader_(participant_),
      truth_reader_(participant_),
      status_reader_(participant_),
      end_reader_(participant_),
      motion_(participant_),
      base_(participant_),
      faults_(participant_) {
  using Info = messaging::SampleInfo;
  loop_.add<msg::Scan>(scans_reader_,
                       [this](const msg::Scan& scan, const Info&) { scans_.push_back(scan); });
  loop_.add<msg::Odometry>(odometry_reader_, [this](const msg::Odometry& sample, const Info&) {
    odometry_.push_back(sample);
  });
  loop_.add<msg::BaseStatus>(
      base_reader_, [this](const msg::BaseStatus& status, const Info&) { base_status_ = status; });
  loop_.add<msg::LaserStatus>(laser_reader_, [this](const msg::LaserStatus& status, const Info&) {
    laser_status_ = status;
  });
  loop_.add<msg::GroundTruth>(
      truth_reader_, [this](const msg::GroundTruth& truth, const Info&) { truth_ = truth; });
  loop_.add<msg::ServiceStatus>(status_reader_,
                                [this](const msg::ServiceStatus& status, const Info&) {
                                  if (status.service() == "sensor_gateway")
                                    gateway_status_ = status;
                                });
  loop_.add<msg::StreamEnd>(end_reader_,
                            [this](const msg::StreamEnd& end, const Info&) { end_ = end; });
}

void GatewayOnDevices::start_simulator() {
  std::vector<std::string> words{
      "--domain",     domain_,       "--partition",
      kPartition,     "--world",     std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml",
      "--laser-port", laser_port_,   "--laser-model",
      laser_model_,   "--base-port", (scratch_ / "base.port").string(),
      "--base-baud",  "38400"};
  if (!config_.empty()) words.insert(words.end(), {"--config", config_.string()});
  simulator_ = std::make_unique<Program>(scratch_, "simulator", words);
}

void GatewayOnDevices::start_gateway(const std::string& keys) {
  const std::filesystem::path file = scratch_ / "devices.yaml";
  std::ofstream(file) << "laser.port: " << laser_port_ << "\nlaser.model: " << laser_model_
                      << "\nbase.port: " << (scratch_ / "base.port").string()
                      << "\nbase.baud: 38400\n"
                      << keys;
  std::vector<std::string> words{"--domain",  domain_,       "--partition", kPartition,
                                 "--devices", file.string(), "--readers",   "1"};
  if (!memory_.empty()) words.insert(words.end(), {"--memory", memory_.string()});
  if (!config_.empty()) words.insert(words.end(), {"--config", config_.string()});
  gateway_ = std::make_unique<Program>(scratch_, "sensor_gateway", words);
}

void GatewayOnDevices::start(std::size_t scans) {
  start_simulator();
  start_gateway();
  ASSERT_TRUE(wait_for([&] {
    return laser_is(msg::kLaserRunning) && base_is(msg::kBaseReady) && scans_.size() >= scans &&
           truth_ && motion_.matched() > 0 && base_.matched() > 0 && faults_.matched() > 0;
  })) << gateway_->err()
      << simulator_->err();
}

void GatewayOnDevices::command(double linear_mps, double angular_radps) {
  msg::MotionCommand message;
  messaging::set_header(message, "robot", command_stamp_ns_.value_or(support::wall_clock_ns()),
                        commands_++);
  message.linear_mps(linear_mps);
  message.angular_radps(angular_radps);
  message.valid_for_s(0.5);
  ASSERT_TRUE(motion_.write(message));
}

void GatewayOnDevices::tell_base(msg::BaseCommandKind kind) {
  msg::BaseCommand message;
  messaging::set_header(message, "robot", 0, commands_++);
  messaging::set_client_id(message, "test");
  message.kind(kind);
  if (base_status_) message.stop_count(base_status_->stop_count());
  ASSERT_TRUE(base_.write(message));
}

void GatewayOnDevices::strike(msg::SimulatedFault fault, msg::SimulatedDevice device,
                              double duration_s) {
  msg::SimulatorCommand message;
  messaging::set_header(message, "robot", 0, commands_++);
  messaging::set_client_id(message, "test");
  message.fault(fault);
  message.device(device);
  message.duration_s(duration_s);
  message.linear_mps(0.2);
  ASSERT_TRUE(faults_.write(message));
  ++strikes_;
}

bool GatewayOnDevices::wait_for_begin() {
  return wait_for([&] {
    const std::string log = simulator_->err();
    int begun = 0;
    for (std::size_t at = 0; (at = log.find("requested by test", at)) != std::string::npos; ++at) {
      ++begun;
    }
    return begun == strikes_;
  });
}

bool GatewayOnDevices::wait_in_world(double duration_s) {
  const double end_s = truth_->time_s() + duration_s;
  return wait_for([&] { return truth_->time_s() > end_s; });
}

std::uint64_t GatewayOnDevices::drops(std::string_view reason) const {
  if (!gateway_status_) return 0;
  for (const msg::FaultCount& drop : gateway_status_->drops()) {
    if (reason == drop.reason().c_str()) return drop.count();
  }
  return 0;
}

double GatewayOnDevices::counter(std::string_view name) const {
  if (!gateway_status_) return 0.0;
  for (const msg::Counter& entry : gateway_status_->counters()) {
    if (name == entry.name().c_str()) return entry.value();
  }
  return 0.0;
}

}  // namespace topogeo::test
