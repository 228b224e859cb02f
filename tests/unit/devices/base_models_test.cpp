#include "topogeo/devices/base_models.hpp"

#include <cmath>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/simulation/base_emulator.hpp"

#include "simulated_line.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kModelMs_ns = 1'000'000;
constexpr std::int64_t kModelSecond_ns = 1000 * kModelMs_ns;

TEST(BaseModels, TheDefaultIsTheB21) {
  EXPECT_EQ(base_models().front().name, "rwi_b21");
  EXPECT_EQ(&base_model("rwi_b21"), &base_models().front());
  EXPECT_THROW((void)base_model("b21"), std::invalid_argument);
}

TEST(BaseModels, NamesAreUnique) {
  std::set<std::string> names;
  for (const BaseModel& model : base_models()) names.emplace(model.name);
  EXPECT_EQ(names.size(), base_models().size());
}

/// A driver and the emulator of its model, whose wheels move as its motors want.
class EachBaseModel : public testing::TestWithParam<std::string> {
 protected:
  EachBaseModel()
      : driver_(make_base_driver(settings_of(GetParam()))),
        emulator_(simulation::make_base_emulator(emulated(GetParam()))),
        line_(*driver_, *emulator_) {}

  static BaseSettings settings_of(const std::string& name) {
    BaseSettings settings;
    settings.model = &base_model(name);
    settings.line.baud = settings.model->baud;
    return settings;
  }
  static simulation::BaseEmulatorSettings emulated(const std::string& name) {
    simulation::BaseEmulatorSettings settings;
    settings.model = &base_model(name);
    settings.baud = settings.model->baud;
    return settings;
  }

  /// Passes time, with a velocity commanded anew every tenth of a second.
  void drive(double linear_mps, double angular_radps, std::int64_t duration_ns) {
    for (std::int64_t passed_ns = 0; passed_ns < duration_ns; passed_ns += 100 * kModelMs_ns) {
      taken_ = driver_->command(linear_mps, angular_radps, line_.now_ns() + 500 * kModelMs_ns,
                                line_.now_ns());
      pass(100 * kModelMs_ns);
    }
  }

  void pass(std::int64_t duration_ns) {
    constexpr std::int64_t kStep_ns = 5 * kModelMs_ns;
    for (std::int64_t passed_ns = 0; passed_ns < duration_ns; passed_ns += kStep_ns) {
      const geometry::Velocity wheels = emulator_->commanded_velocity();
      constexpr double kStep_s = 1e-9 * kStep_ns;
      emulator_->moved(kStep_s * wheels.linear_m_per_s, kStep_s * wheels.angular_rad_per_s,
                       kStep_s);
      driven_m_ += std::fabs(kStep_s * wheels.linear_m_per_s);
      line_.run_for(kStep_ns);
      for (const BaseOdometry& odometry : driver_->take_odometry()) last_ = odometry;
    }
  }

  bool start() {
    line_.plug_in();
    for (int i = 0; i < 100 && !driver_->status().commands_taken; ++i) pass(100 * kModelMs_ns);
    return driver_->status().commands_taken;
  }

  std::unique_ptr<BaseDriver> driver_;
  std::unique_ptr<simulation::BaseEmulator> emulator_;
  SimulatedLine line_;
  BaseOdometry last_;
  double driven_m_ = 0.0;
  bool taken_ = false;
};

TEST_P(EachBaseModel, DrivesAsCommandedAndReportsIt) {
  EXPECT_EQ(driver_->status().state, BaseState::kOffline);
  ASSERT_TRUE(start()) << driver_->status().reason;
  drive(0.2, 0.0, 4 * kModelSecond_ns);
  EXPECT_TRUE(taken_);
  EXPECT_EQ(driver_->status().state, BaseState::kMoving);
  drive(0.0, 0.0, 2 * kModelSecond_ns);
  EXPECT_GT(driven_m_, 0.6);
  EXPECT_NEAR(last_.T_odom_robot.x_m, driven_m_, 0.02);
  EXPECT_TRUE(driver_->status().stands);
  drive(0.0, 0.4, 3 * kModelSecond_ns);
  EXPECT_GT(last_.T_odom_robot.theta_rad, 0.6);
}

TEST_P(EachBaseModel, StopsWhenCommandsCease) {
  ASSERT_TRUE(start()) << driver_->status().reason;
  drive(0.2, 0.0, 2 * kModelSecond_ns);
  pass(2 * kModelSecond_ns);
  EXPECT_EQ(emulator_->commanded_velocity().linear_m_per_s, 0.0);
}

TEST_P(EachBaseModel, StopsWhenTheDriverIsFrozen) {
  ASSERT_TRUE(start()) << driver_->status().reason;
  drive(0.2, 0.0, 2 * kModelSecond_ns);
  line_.freeze_host(true);
  if (!driver_->stop_bytes().empty()) {  // the gateway has a process that writes them
    pass(300 * kModelMs_ns);
    EXPECT_GT(emulator_->commanded_velocity().linear_m_per_s, 0.1) << "obeys its last speeds";
    emulator_->receive(driver_->stop_bytes(), settings_of(GetParam()).line, line_.now_ns());
  }
  pass(2 * kModelSecond_ns);
  EXPECT_EQ(emulator_->commanded_velocity().linear_m_per_s, 0.0);
}

TEST_P(EachBaseModel, RefusesCommandsAfterAHaltUntilAReset) {
  ASSERT_TRUE(start()) << driver_->status().reason;
  driver_->halt(line_.now_ns());
  drive(0.2, 0.0, kModelSecond_ns);
  EXPECT_FALSE(taken_);
  EXPECT_EQ(driver_->status().state, BaseState::kHalted);
  EXPECT_TRUE(driver_->held_stops().halt);
  driver_->reset_stop(line_.now_ns());
  pass(kModelSecond_ns);
  EXPECT_EQ(emulator_->commanded_velocity().linear_m_per_s, 0.0) << "not before the next command";
  drive(0.2, 0.0, kModelSecond_ns);
  EXPECT_TRUE(taken_);
}

std::vector<std::string> base_names() {
  std::vector<std::string> names;
  for (const BaseModel& model : base_models()) names.emplace_back(model.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(All, EachBaseModel, testing::ValuesIn(base_names()),
                         [](const auto& base) { return base.param; });

}  // namespace
}  // namespace topogeo::devices
