#include "simulator_service.hpp"

#include <cmath>
#include <string>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/log.hpp"

namespace topogeo::simulator {
namespace {

/// Ports deliver more often than a USB adapter with its usual latency timer; each delivery wakes
/// the gateway.
constexpr std::chrono::milliseconds kTick{2};
/// Period of the true pose: often enough to judge every scan by it.
constexpr std::int64_t kTruthPeriod_ns = 20'000'000;
/// Period of a ring of sonars that fire in turns.
constexpr std::int64_t kBodyPeriod_ns = 100'000'000;
/// Period of the status counters, for people.
constexpr std::int64_t kStatePeriod_ns = 1'000'000'000;
constexpr std::chrono::nanoseconds kLatest{simulation::kLongestCatchUp_ns};
constexpr double kLookAhead_m = 5.0;

std::int64_t nanoseconds(std::chrono::nanoseconds duration) {
  return duration.count();
}

}  // namespace

SimulatedWorld::SimulatedWorld(world::World world, const SimulatorOptions& simulator)
    : options(simulator),
      devices(std::move(world), options.devices),
      start(Clock::now()),
      start_stamp_ns(nanoseconds(std::chrono::system_clock::now().time_since_epoch())) {}

SimulatorService::SimulatorService(service::Service& service, SimulatedWorld& world)
    : service_(service),
      world_(world),
      devices_(world.devices),
      truth_(service.advertise<msg::GroundTruth>()),
      body_sensors_([this](std::int64_t) { return devices_.robot().scene(); },
                    [this](std::int64_t) { return devices_.robot().T_world_robot(); },
                    [this] { return devices_.robot().sonar(); }),
      body_(service, body_sensors_, world.options.devices.robot.sonars) {
  service.subscribe<msg::SimulatorCommand>(
      [this](const msg::SimulatorCommand& command) { on_command(command); });
  service_.loop().add_timer(kTick, [this] { tick(); });
  const DeviceOptions& devices = world.options.devices;
  service_.status().set_state(msg::kServiceRunning, "laser at " + devices.laser_port.string() +
                                                        ", base at " + devices.base_port.string());
}

std::int64_t SimulatorService::stamp_ns() const {
  return world_.start_stamp_ns +
         std::llround(static_cast<double>(devices_.now_ns()) / world_.options.time_factor);
}

void SimulatorService::tick() {
  const double time_factor = world_.options.time_factor;
  const auto passed = SimulatedWorld::Clock::now() - world_.start;
  const auto done =
      std::chrono::nanoseconds(std::llround(static_cast<double>(devices_.now_ns()) / time_factor));
  if (const auto late = passed - done - kLatest; late.count() > 0) {
    service_.status().add_to_counter("stood_still_s", std::chrono::duration<double>(late).count());
    // The clock of a real base never stops for its host.
    devices_.stand_still(std::llround(static_cast<double>(nanoseconds(late)) * time_factor));
  }
  devices_.run_until(std::llround(static_cast<double>(nanoseconds(passed)) * time_factor));
  world_.faults.tick();
  const std::int64_t now_ns = devices_.now_ns();
  if (now_ns >= truth_due_ns_) {
    truth_due_ns_ = now_ns - now_ns % kTruthPeriod_ns + kTruthPeriod_ns;
    publish_truth();
  }
  if (now_ns >= body_due_ns_) {
    body_due_ns_ = now_ns - now_ns % kBodyPeriod_ns + kBodyPeriod_ns;
    body_.publish(now_ns, stamp_ns());
  }
  if (now_ns >= state_due_ns_) {
    state_due_ns_ = now_ns + kStatePeriod_ns;
    publish_state();
  }
}

void SimulatorService::publish_truth() {
  const simulation::SimulatedRobot& robot = devices_.robot();
  msg::GroundTruth truth;
  messaging::set_header(truth, service_.robot_id(), stamp_ns(), truths_++);
  truth.time_s(static_cast<double>(devices_.now_ns()) * 1e-9);
  truth.T_world_robot(service::to_msg(robot.T_world_robot()));
  truth.linear_mps(robot.velocity().linear_m_per_s);
  truth.angular_radps(robot.velocity().angular_rad_per_s);
  truth.free_ahead_m(robot.free_ahead_m(kLookAhead_m));
  truth.touching(robot.bumped_rad().has_value());
  truth.touching_rad(robot.bumped_rad().value_or(0.0));
  truth.collisions(robot.collisions());
  truth.run_into(robot.run_into());
  if (!truth_.write(truth)) service_.status().fault("send blocked", "ground truth");
}

void SimulatorService::publish_state() {
  messaging::StatusPublisher& status = service_.status();
  simulation::SimulatedRobot& robot = devices_.robot();
  status.set_counter("time_s", robot.time_s());
  status.set_counter("way_m", robot.path_m());
  status.set_counter("collisions", static_cast<double>(robot.collisions()));
  status.set_counter("run_into", static_cast<double>(robot.run_into()));
  status.set_counter("laser_scans", static_cast<double>(devices_.laser().scans_sent()));
  status.set_counter("base_reports", static_cast<double>(devices_.base().reports()));
  status.set_counter("bytes_lost", static_cast<double>(devices_.bytes_lost()));
}

void SimulatorService::on_command(const msg::SimulatorCommand& command) {
  const Fault fault = fault_from_msg(command);
  spdlog::info("{}, requested by {}", describe(fault), command.client_id().c_str());
  world_.faults.begin(fault);
  service_.status().add_to_counter("faults_made");
}

}  // namespace topogeo::simulator
