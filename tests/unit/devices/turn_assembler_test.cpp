#include "topogeo/devices/turn_assembler.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::devices {
namespace {

constexpr double kAssemblerTurn_rad = 2.0 * std::numbers::pi;
constexpr std::int64_t kTurnTime_ns = 100'000'000;

/// A laser in a square room of 4 m, turned from the middle of the walls by nothing.
double room_range_m(double angle_rad) {
  return 2.0 / std::max(std::fabs(std::cos(angle_rad)), std::fabs(std::sin(angle_rad)));
}

struct Spinner {
  TurnAssembler assembler;
  double sense = -1.0;  ///< angles of the laser frame by angle turned
  double turned_rad = 0.0;
  std::int64_t time_ns = 0;
  std::vector<LaserScan> scans{};

  /// Turns by `turns` with so many beams a turn; without those for which `lost(angle)` holds.
  template <class Lost>
  void spin(double turns, double beams_per_turn, Lost lost) {
    const auto count = static_cast<int>(std::lround(turns * beams_per_turn));
    for (int i = 0; i < count; ++i) {
      const double angle_rad = sense * turned_rad;
      if (!lost(std::remainder(angle_rad, kAssemblerTurn_rad))) {
        assembler.add(
            {std::fmod(turned_rad, kAssemblerTurn_rad), room_range_m(angle_rad), time_ns});
        if (auto scan = assembler.take_scan()) scans.push_back(*std::move(scan));
      }
      turned_rad += kAssemblerTurn_rad / beams_per_turn;
      time_ns += std::llround(static_cast<double>(kTurnTime_ns) / beams_per_turn);
    }
  }
  void spin(double turns, double beams_per_turn) {
    spin(turns, beams_per_turn, [](double) { return false; });
  }
};

double angle_of_beam(const LaserScan& scan, std::size_t beam) {
  return scan.angle_min_rad + static_cast<double>(beam) * scan.angle_step_rad;
}

void expect_room(const LaserScan& scan) {
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    EXPECT_NEAR(scan.ranges_m[i], room_range_m(angle_of_beam(scan, i)), 0.02) << "beam " << i;
  }
}

TEST(TurnAssembler, MapsAnyNumberOfBeamsToOneGridAndLosesNoTurn) {
  Spinner laser{TurnAssembler({}, 450, 12.0, true)};
  // Turns of 449.4 to 520.6 beams: none has a whole number, and no two the same.
  for (const double beams : {449.4, 450.3, 463.7, 481.9, 500.2, 520.6}) laser.spin(5.0, beams);
  EXPECT_EQ(laser.scans.size(), 29U);  // the first begins in the middle of a turn
  EXPECT_EQ(laser.assembler.incomplete(), 1U);
  for (const LaserScan& scan : laser.scans) {
    ASSERT_EQ(scan.ranges_m.size(), 450U);
    EXPECT_DOUBLE_EQ(scan.angle_step_rad, kAssemblerTurn_rad / 450.0);
    EXPECT_NEAR(scan.angle_min_rad, 0.5 * scan.angle_step_rad - std::numbers::pi, 1e-12);
    expect_room(scan);
  }
}

TEST(TurnAssembler, TellsTheTimeOfEachBeam) {
  Spinner laser{TurnAssembler({}, 450, 12.0, true)};
  laser.spin(3.0, 450.0);
  ASSERT_EQ(laser.scans.size(), 2U);
  // The laser starts ahead and turns clockwise: it looks back after half a turn, ahead after one.
  const LaserScan& scan = laser.scans[0];
  EXPECT_NEAR(static_cast<double>(scan.stamp_ns), 1.0 * kTurnTime_ns, 3e5);
  const auto time_ns = [&](double angle_rad) {
    const double beam = (angle_rad - scan.angle_min_rad) / scan.angle_step_rad;
    return static_cast<double>(scan.stamp_ns) + 1e9 * (scan.first_beam_s + beam * scan.time_step_s);
  };
  EXPECT_NEAR(time_ns(0.0), 1.0 * kTurnTime_ns, 3e5);
  EXPECT_NEAR(time_ns(0.5 * std::numbers::pi), 0.75 * kTurnTime_ns, 3e5);
  EXPECT_NEAR(time_ns(-0.5 * std::numbers::pi), 1.25 * kTurnTime_ns, 3e5);
  EXPECT_LT(scan.time_step_s, 0.0);
  EXPECT_EQ(laser.scans[1].stamp_ns > scan.stamp_ns, true);
}

TEST(TurnAssembler, MirrorsALaserThatHangsUpsideDown) {
  TurningLaserSettings hanging;
  hanging.upside_down = true;
  TurnAssembler upright({}, 360, 12.0, true);
  TurnAssembler hangs(hanging, 360, 12.0, true);
  std::vector<LaserScan> scans;
  for (TurnAssembler* laser : {&upright, &hangs}) {
    for (int i = 0; i < 1100; ++i) {
      const double turned_rad = std::fmod(i * kAssemblerTurn_rad / 400.0, kAssemblerTurn_rad);
      // A wall on the laser's right when it stands: the first half of its turn.
      laser->add({turned_rad, turned_rad < std::numbers::pi ? 1.0 : 3.0, 250'000LL * i});
      if (auto scan = laser->take_scan()) scans.push_back(*std::move(scan));
    }
  }
  ASSERT_EQ(scans.size(), 4U);
  const LaserScan& stands = scans[0];
  const LaserScan& hung = scans[2];
  for (std::size_t i = 2; i < 358; ++i) {
    const double angle_rad = angle_of_beam(stands, i);
    if (std::fabs(angle_rad) < 0.03) continue;
    EXPECT_NEAR(stands.ranges_m[i], angle_rad < 0.0 ? 1.0F : 3.0F, 1e-3F) << i;
    EXPECT_NEAR(hung.ranges_m[i], angle_rad > 0.0 ? 1.0F : 3.0F, 1e-3F) << i;
  }
  EXPECT_GT(hung.time_step_s, 0.0);
}

TEST(TurnAssembler, ATurnThatLacksLittleKeepsItsOtherBeams) {
  Spinner laser{TurnAssembler({}, 450, 12.0, true)};
  laser.spin(0.6, 450.0);
  laser.spin(1.0, 450.0, [](double angle_rad) { return angle_rad > 1.0 && angle_rad < 1.2; });
  ASSERT_EQ(laser.scans.size(), 1U);
  std::size_t missing = 0;
  for (std::size_t i = 0; i < 450; ++i) {
    const double angle_rad = angle_of_beam(laser.scans[0], i);
    const bool within = angle_rad > 1.02 && angle_rad < 1.18;
    if (within) {
      EXPECT_EQ(laser.scans[0].ranges_m[i], 0.0F) << i;
      ++missing;
    } else if (angle_rad < 0.98 || angle_rad > 1.22) {
      EXPECT_NEAR(laser.scans[0].ranges_m[i], room_range_m(angle_rad), 0.02) << i;
    }
  }
  EXPECT_GT(missing, 5U);
}

TEST(TurnAssembler, ATurnThatLacksMuchIsDropped) {
  Spinner laser{TurnAssembler({}, 450, 12.0, true)};
  laser.spin(0.6, 450.0);
  const std::uint64_t before = laser.assembler.incomplete();
  laser.spin(1.0, 450.0, [](double angle_rad) { return angle_rad > 1.0 && angle_rad < 1.8; });
  EXPECT_TRUE(laser.scans.empty());
  EXPECT_EQ(laser.assembler.incomplete(), before + 1);
  laser.spin(1.0, 450.0);
  EXPECT_EQ(laser.scans.size(), 1U);
}

TEST(TurnAssembler, AJumpBeginsANewTurn) {
  Spinner laser{TurnAssembler({}, 450, 12.0, true)};
  laser.spin(1.2, 450.0);
  laser.turned_rad += 2.0;
  laser.spin(0.2, 450.0);
  EXPECT_TRUE(laser.scans.empty());
  EXPECT_GE(laser.assembler.incomplete(), 1U);
}

TEST(TurnAssembler, RangesBeyondTheLimitsAreNoReturn) {
  TurningLaserSettings settings;
  settings.range_min_m = 2.1;
  settings.range_max_m = 2.7;
  Spinner laser{TurnAssembler(settings, 450, 12.0, true)};
  laser.spin(1.7, 450.0);
  ASSERT_EQ(laser.scans.size(), 1U);
  for (std::size_t i = 0; i < 450; ++i) {
    const double range_m = room_range_m(angle_of_beam(laser.scans[0], i));
    if (range_m < 2.05 || range_m > 2.75) {
      EXPECT_EQ(laser.scans[0].ranges_m[i], 0.0F);
    } else if (range_m > 2.15 && range_m < 2.65) {
      EXPECT_NEAR(laser.scans[0].ranges_m[i], range_m, 0.02);
    }
  }
}

}  // namespace
}  // namespace topogeo::devices
