#include "base_keys.hpp"

#include <string>
#include <utility>
#include <vector>

#include "topogeo/devices/base_models.hpp"

namespace topogeo::sensor_gateway {

using devices::BaseDialect;
using devices::McpChecksum;
using devices::Parity;
using support::ConfigSchema;

namespace {

void describe_base_line(ConfigSchema& schema, DeviceFile::Base& base) {
  devices::BaseSettings& s = base.settings;
  schema.add("base.port", &base.port,
             "serial port of the base; empty: no base, and the odometry reports a robot that "
             "stands still");
  std::vector<std::pair<std::string, const devices::BaseModel*>> models;
  for (const devices::BaseModel& model : devices::base_models()) {
    models.emplace_back(model.name, &model);
  }
  schema.add("base.model", &s.model, models, "what the base is (docs/devices.md has the table)");
  schema.add(
      "base.baud", &base.baud, 0U, 500'000U, "baud",
      "rate of the line; 0: that of the model: 9600 for a B21, although one uses 38400, 9600 for "
      "a pioneer, and 115200 for the others");
  schema.add("base.parity", &s.line.parity,
             {{"none", Parity::kNone}, {"even", Parity::kEven}, {"odd", Parity::kOdd}},
             "parity of the line");
  schema.add(
      "base.dialect", &s.dialect,
      {{"ascii", BaseDialect::kAscii}, {"binary", BaseDialect::kBinary}},
      "ascii: text commands; binary: the direct mode, which reports more often on a slow line");
  schema.add(
      "base.checksum", &s.checksum,
      {{"learn", McpChecksum::kLearn}, {"drop", McpChecksum::kDrop}, {"warn", McpChecksum::kWarn}},
      "treatment of binary messages with a wrong check byte; its rule is from one source, so learn "
      "drops them only after three messages with the right one");
  schema.add("base.report_mask", &base.report_mask, 0U, 0xFFFF'FFFFU, "",
             "fields of the status reports, one bit each");
  schema.add("base.report_period_s", &s.report_period_s, 0.0, 2.0, "s",
             "time between two reports; 0: as short as the line allows");
  schema.add("base.write_gap_s", &s.write_gap_s, 0.0, 1.0, "s",
             "time between two commands; the base of one source loses commands that follow sooner");
  schema.add("base.direct_mode_wait_s", &s.direct_mode_wait_s, 0.0, 5.0, "s",
             "time from the request for the direct mode to its first packet");
  schema.add("base.silence_s", &s.silence_s, 0.05, 60.0, "s",
             "time without a report, and at least four periods, after which the base is offline");
}

void describe_base_units(ConfigSchema& schema, DeviceFile::Base& base) {
  devices::McpCalibration& c = base.settings.calibration;
  schema.add("base.counts_per_m", &c.counts_per_m, 1000.0, 1e6, "1/m",
             "encoder counts per metre: 28120 for a B21, 25630 for a B21b, 27300 to 54820 in other "
             "sources. Measure it before the first drive: twice the number is twice the speed");
  schema.add("base.position_units_per_m", &c.position_units_per_m, 0.0, 1e6, "1/m",
             "units of the position per metre; 0: counts_per_m / 256");
  schema.add("base.rotation_counts_per_turn", &c.rotation_counts_per_turn, 16.0, 1e6, "",
             "rotation counts per whole turn");
  schema.add("base.clockwise_positive", &c.clockwise_positive,
             "the base counts rotation clockwise, as a B21 does; other RWI bases do not");
  schema.add("base.reversed", &c.reversed, "forward of the base is backward of the robot");
}

void describe_text_base(ConfigSchema& schema, DeviceFile::Base& base) {
  devices::TextBaseSettings& t = base.settings.text;
  schema.add("base.ticks_per_m", &t.ticks_per_m, 1.0, 1e7, "1/m",
             "encoder ticks of a wheel of a microcontroller per metre; measure it before the first "
             "drive");
  schema.add("base.track_m", &t.track_m, 0.01, 10.0, "m",
             "distance between the wheels of a microcontroller");
  schema.add("base.mixes", &t.mixes,
             "true: a microcontroller gets its speed and rate of turn (W), and mixes the wheels "
             "itself; false: it gets the speeds of its wheels (V)");
  schema.add("base.gyro", &t.gyro,
             "the heading of a microcontroller follows its gyro where it reports one; false: its "
             "wheels");
}

void describe_create(ConfigSchema& schema, DeviceFile::Base& base) {
  devices::CreateSettings& c = base.settings.create;
  schema.add("base.create_ticks_per_m", &c.ticks_per_m, 1.0, 1e7, "1/m",
             "encoder counts of a wheel of a create2 per metre, as its specification states; "
             "another driver takes wheels of 78 mm, which gives 2076");
  schema.add("base.create_track_m", &c.track_m, 0.01, 10.0, "m",
             "distance between the wheels of a create2, as its specification states");
}

void describe_kobuki(ConfigSchema& schema, DeviceFile::Base& base) {
  devices::KobukiSettings& k = base.settings.kobuki;
  schema.add("base.kobuki_ticks_per_m", &k.ticks_per_m, 1.0, 1e7, "1/m",
             "encoder ticks of a wheel of a kobuki per metre, of its maker's driver");
  schema.add("base.kobuki_track_m", &k.track_m, 0.01, 10.0, "m",
             "distance between the wheels of a kobuki, of its maker's driver");
  schema.add("base.kobuki_gyro", &k.gyro,
             "the heading of a kobuki follows its gyro; false: its wheels");
}

void describe_pioneer(ConfigSchema& schema, DeviceFile::Base& base) {
  devices::PioneerSettings& p = base.settings.pioneer;
  schema.add("base.pioneer_units_per_m", &p.units_per_m, 1.0, 1e6, "1/m",
             "units of the position of a pioneer per metre: 1000 with ARCOS; others divide 1000 by "
             "DistConvFactor of the maker's parameter file");
  schema.add("base.pioneer_units_per_turn", &p.units_per_turn, 1.0, 1e6, "",
             "units of the heading of a pioneer per turn; 4096 gives AngleConvFactor 0.001534 of "
             "the maker's parameter files");
  schema.add("base.pioneer_sonar_units_per_m", &p.sonar_units_per_m, 1.0, 1e6, "1/m",
             "units of the sonars of a pioneer per metre: 1000 with ARCOS; others divide 1000 by "
             "RangeConvFactor of the maker's parameter file");
}

void describe_roboteq(ConfigSchema& schema, DeviceFile::Base& base) {
  devices::RoboteqSettings& r = base.settings.roboteq;
  schema.add("base.roboteq_ticks_per_m", &r.ticks_per_m, 1.0, 1e7, "1/m",
             "encoder counts of a wheel of a roboteq per metre; measure it before the first drive");
  schema.add("base.roboteq_track_m", &r.track_m, 0.01, 10.0, "m",
             "distance between the wheels of a roboteq");
  schema.add("base.roboteq_motor_turns_per_m", &r.motor_turns_per_m, 0.01, 1e4, "1/m",
             "turns of a motor of a roboteq per metre");
  schema.add("base.roboteq_full_rpm", &r.full_rpm, 0.0, 1e5, "1/min",
             "a roboteq gets shares of this speed (!G), its MXRPM; 0: turns a minute (!S)");
  schema.add("base.roboteq_left_channel", &r.left_channel, 1U, 2U, "",
             "channel of the left motor of a roboteq; the right one is the other");
  schema.add("base.roboteq_left_reversed", &r.left_reversed,
             "the left motor of a roboteq turns backwards when the robot drives ahead");
  schema.add("base.roboteq_right_reversed", &r.right_reversed, "the same for the right motor");
}

void describe_vesc(ConfigSchema& schema, DeviceFile::Base& base) {
  devices::VescSettings& v = base.settings.vesc;
  schema.add("base.vesc_pole_pairs", &v.pole_pairs, 1U, 1000U, "",
             "pairs of poles of a motor of a vesc");
  schema.add("base.vesc_motor_turns_per_m", &v.motor_turns_per_m, 0.01, 1e4, "1/m",
             "turns of a motor of a vesc per metre; measure it before the first drive");
  schema.add("base.vesc_track_m", &v.track_m, 0.01, 10.0, "m",
             "distance between the wheels of a vesc");
  schema.add("base.vesc_can_id", &v.can_id, 0U, 253U, "",
             "number of the second vesc on the CAN bus of the one at the port");
  schema.add("base.vesc_port_is_right", &v.port_is_right,
             "the vesc at the port drives the right wheel; false: the left one");
  schema.add("base.vesc_left_reversed", &v.left_reversed,
             "the left motor of a vesc turns backwards when the robot drives ahead");
  schema.add("base.vesc_right_reversed", &v.right_reversed, "the same for the right motor");
}

void describe_base_motion(ConfigSchema& schema, DeviceFile::Base& base) {
  devices::BaseSettings& s = base.settings;
  schema.add("base.largest_linear_mps", &s.limits.linear_mps, 0.01, 2.0, "m/s",
             "largest speed; faster motion commands are limited to it");
  schema.add("base.largest_angular_radps", &s.limits.angular_radps, 0.01, 6.0, "rad/s",
             "the same for rotation");
  schema.add("base.linear_acceleration_mps2", &s.limits.linear_mps2, 0.01, 5.0, "m/s^2",
             "acceleration of starting and stopping; the base stops no sooner than this allows");
  schema.add("base.angular_acceleration_radps2", &s.limits.angular_radps2, 0.01, 20.0, "rad/s^2",
             "the same for rotation");
  schema.add("base.torque", &base.torque, -1, 255, "",
             "torque limit of the motors; one source recommends 20; -1: unchanged");
  schema.add("base.watchdog_s", &s.watchdog_s, 0.1, 255.0, "s",
             "the base stops by itself when its watchdog has not been refreshed for this time, so "
             "it runs on while the gateway is frozen. A longer time needs the same in "
             "guard.runs_on_s of the configuration");
  schema.add("base.command_timeout_s", &s.command_timeout_s, 0.05, 0.5, "s",
             "a motion command holds no longer than this");
  schema.add("base.joystick_allowed", &s.joystick_allowed,
             "leaves the joystick in use; without it an operator has to push the robot");
  schema.add("base.stop_on_bump", &s.stop_on_bump, "the base stops by itself when it bumps");
  schema.add("base.error_delay_ticks", &base.error_delay_ticks, 0U, 65535U, "1/256 s",
             "time from an error of the motors to their shutdown");
}

void describe_base_states(ConfigSchema& schema, DeviceFile::Base& base) {
  devices::BaseSettings& s = base.settings;
  schema.add("base.stalled_reports", &s.stalled_reports, 2U, 100U, "",
             "reports in a row of acceleration without motion that count as an emergency stop, "
             "because no message for it is known");
  schema.add("base.standstill_mps", &s.standstill_mps, 0.0, 0.5, "m/s",
             "lower speeds are standstill");
  schema.add("base.standstill_radps", &s.standstill_radps, 0.0, 1.0, "rad/s",
             "the same for rotation");
  schema.add(
      "base.ripple_mps", &s.ripple_mps, 0.001, 2.0, "m/s",
      "an axis that is slower than commanded by more than this, and reports that it accelerates, "
      "has lost its power: an emergency stop. Raise it if a base is held without one");
  schema.add("base.ripple_radps", &s.ripple_radps, 0.001, 6.0, "rad/s", "the same for rotation");
  schema.add("base.ramp_mps", &s.ramp_mps, 0.001, 2.0, "m/s",
             "the same for an axis that lags behind its acceleration");
  schema.add("base.ramp_radps", &s.ramp_radps, 0.001, 6.0, "rad/s", "the same for rotation");
  schema.add("base.uncommanded_mps", &s.uncommanded_mps, 0.005, 2.0, "m/s",
             "motion that is faster than commanded by this comes from the joystick");
  schema.add("base.uncommanded_radps", &s.uncommanded_radps, 0.01, 6.0, "rad/s",
             "the same for rotation");
  schema.add("base.battery_period_s", &s.battery_period_s, 1.0, 3600.0, "s",
             "time between two requests for the voltage");
  schema.add("base.battery_low_v", &base.battery_low_v, 0.0, 100.0, "V",
             "the battery is low below this voltage; 0: that of the model: 44 for a B21, 13 for a "
             "create2 (a guess), 14 for a kobuki, 11.75 for a pioneer, never for "
             "the others");
}

}  // namespace

void describe_base(DeviceFile::Base& base, ConfigSchema& schema) {
  describe_base_line(schema, base);
  describe_base_units(schema, base);
  describe_text_base(schema, base);
  describe_create(schema, base);
  describe_kobuki(schema, base);
  describe_pioneer(schema, base);
  describe_roboteq(schema, base);
  describe_vesc(schema, base);
  describe_base_motion(schema, base);
  describe_base_states(schema, base);
}

}  // namespace topogeo::sensor_gateway
