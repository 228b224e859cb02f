// Publishes the readings of a robot's body sensors: topics sonar and body_sensors.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "topogeo/devices/body_sensors.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/body.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/service/service.hpp"

namespace topogeo::service {

/// Lives in the loop of its service.
class BodySensorPublisher {
 public:
  /// `sonars` are the mounts of the sonars that `sensors` reads; `sensors` must outlive this
  /// object. Infrared and tactile sensors are placed as on a B21.
  BodySensorPublisher(Service& service, devices::BodySensors& sensors,
                      std::vector<devices::SonarMount> sonars);

  /// Reads the sensors and sends the readings with this stamp. `now_ns` is of the sensors' clock.
  void publish(std::int64_t now_ns, std::int64_t stamp_ns);

  /// Why nothing is sent, as text for the user; empty when readings are sent.
  [[nodiscard]] std::string fault() const { return sensors_.fault(); }

 private:
  void publish_sonar(const devices::BodyReadings& readings, std::int64_t stamp_ns);
  void publish_body(const devices::BodyReadings& readings, std::int64_t stamp_ns);

  Service& service_;
  devices::BodySensors& sensors_;
  std::vector<devices::SonarMount> sonars_;
  std::vector<devices::SonarMount> infrared_;
  messaging::Writer<msg::Sonar> sonar_out_;
  messaging::Writer<msg::BodySensors> body_out_;
  std::uint64_t sent_ = 0;
};

}  // namespace topogeo::service
