#include "topogeo/service/body_sensor_publisher.hpp"

#include <algorithm>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"

namespace topogeo::service {

BodySensorPublisher::BodySensorPublisher(Service& service, devices::BodySensors& sensors,
                                         std::vector<devices::SonarMount> sonars)
    : service_(service),
      sensors_(sensors),
      sonars_(std::move(sonars)),
      infrared_(devices::b21_body_infrared().mounts),
      sonar_out_(service.advertise<msg::Sonar>()),
      body_out_(service.advertise<msg::BodySensors>()) {
  const devices::RangeRing base = devices::b21_base_infrared();
  infrared_.insert(infrared_.end(), base.mounts.begin(), base.mounts.end());
}

void BodySensorPublisher::publish(std::int64_t now_ns, std::int64_t stamp_ns) {
  const std::optional<devices::BodyReadings> readings = sensors_.read(now_ns);
  if (!readings) return;
  publish_sonar(*readings, stamp_ns);
  publish_body(*readings, stamp_ns);
  ++sent_;
}

void BodySensorPublisher::publish_sonar(const devices::BodyReadings& readings,
                                        std::int64_t stamp_ns) {
  msg::Sonar round;
  messaging::set_header(round, service_.robot_id(), stamp_ns, sent_);
  for (std::size_t i = 0; i < std::min(sonars_.size(), readings.sonar_m.size()); ++i) {
    msg::SonarEcho echo;
    echo.T_robot_sonar(to_msg(sonars_[i].T_robot_sonar));
    echo.range_m(readings.sonar_m[i]);
    echo.half_cone_rad(static_cast<float>(sonars_[i].half_cone_rad));
    round.echoes().push_back(echo);
  }
  if (!sonar_out_.write(round)) service_.status().fault("send blocked", "sonar");
}

void BodySensorPublisher::publish_body(const devices::BodyReadings& readings,
                                       std::int64_t stamp_ns) {
  msg::BodySensors body;
  messaging::set_header(body, service_.robot_id(), stamp_ns, sent_);
  std::vector<float> ranges_m = readings.body_infrared_m;
  ranges_m.insert(ranges_m.end(), readings.base_infrared_m.begin(), readings.base_infrared_m.end());
  for (std::size_t i = 0; i < std::min(infrared_.size(), ranges_m.size()); ++i) {
    msg::InfraredReading reading;
    reading.T_robot_sensor(to_msg(infrared_[i].T_robot_sonar));
    reading.range_m(ranges_m[i]);
    body.infrared().push_back(reading);
  }
  body.body_pressed(static_cast<std::uint32_t>(readings.body_pressed.to_ulong()));
  body.body_panels(static_cast<std::uint32_t>(readings.body_pressed.size()));
  body.base_pressed(static_cast<std::uint32_t>(readings.base_pressed.to_ulong()));
  body.base_panels(static_cast<std::uint32_t>(readings.base_pressed.size()));
  if (!body_out_.write(body)) service_.status().fault("send blocked", "body sensors");
}

}  // namespace topogeo::service
