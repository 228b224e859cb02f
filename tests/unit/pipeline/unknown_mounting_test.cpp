// Messages about a mounting that was searched.
#include "topogeo/pipeline/unknown_mounting.hpp"

#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::pipeline {
namespace {

using localization::FoundMounting;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

FoundMounting backwards() {
  FoundMounting found;
  found.heading_known = true;
  found.position_known = true;
  found.T_robot_laser = {-0.2, 0.05, std::numbers::pi};
  found.position_spread_m = 0.04;
  found.heading_spread_rad = 0.02;
  found.motions = 30;
  found.fitting = 29;
  found.heading = {18, 0};
  return found;
}

TEST(UnknownMounting, IsSaidInOneLine) {
  FoundMounting found = backwards();
  EXPECT_EQ(text_of(found),
            "the laser's mounting is unknown; the scans show -0.20 m ahead, 0.05 m to the left (+- "
            "0.04 m), 180.0 deg (+- 1.1 deg), confidence 95 % (29 of 30 motions fit)");
  found.upside_down = true;
  EXPECT_THAT(text_of(found), HasSubstr("(+- 1.1 deg), upside down, confidence"));
}

TEST(UnknownMounting, WhatIsNotShownHasItsFlag) {
  FoundMounting found = backwards();
  found.position_known = false;
  found.T_robot_laser = {0.0, 0.0, std::numbers::pi};
  EXPECT_THAT(text_of(found), HasSubstr("--laser X,Y,3.1416 states them"));
  EXPECT_THAT(text_of(found), Not(HasSubstr("ahead")));
  found = {};
  EXPECT_THAT(text_of(found), HasSubstr("only 0 motions of the robot have matching scans"));
  EXPECT_THAT(text_of(found), HasSubstr("--laser X,Y,YAW states it"));
  found.motions = 20;
  found.fitting = 20;
  found.heading = {3, 2};
  EXPECT_THAT(text_of(found), HasSubstr("3 motions speak for the best one, 2 for another"));
  found.fitting = 4;
  EXPECT_THAT(text_of(found), HasSubstr("only 4 of 20 motions fit the best one"));
}

TEST(UnknownMounting, OnlyAClearContradictionIsAWarning) {
  FoundMounting found = backwards();
  EXPECT_THAT(contradiction(found, {0.3, 0.0, -3.0}), IsEmpty());  // 9 degrees
  EXPECT_THAT(contradiction(found, {0.0, 0.0, 1.5}),
              HasSubstr("they show it at 180 deg (29 of 30 motions fit); if they are right: "
                        "--laser -0.2,0.05,3.14"));
  found.heading_known = false;
  EXPECT_THAT(contradiction(found, {0.0, 0.0, 1.5}), IsEmpty());
  found.upside_down = true;
  EXPECT_THAT(contradiction(found, {0.0, 0.0, 1.5}),
              HasSubstr("they show it upside down, or mirrored (29 of 30 motions fit); if they are "
                        "right: --upside-down"));
}

TEST(UnknownMounting, AHeadingThatNearlyAllMotionsContradictIsNotUsed) {
  FoundMounting found = backwards();
  EXPECT_THAT(other_heading(found, {0.3, 0.0, -3.0}), IsEmpty());  // 9 degrees
  EXPECT_EQ(other_heading(found, {0.1, 0.0, 0.0}),
            "the laser is stated at 0 deg, but the scans show it at 180 deg (29 of 30 motions "
            "fit): if they are right, expected --laser -0.2,0.05,3.1416; if the stated "
            "mounting is, expected --laser 0.1,0,0");
  EXPECT_THAT(other_heading(found, {0.18, 0.0, 0.0}), IsEmpty()) << "the odometry is turned";
  found.fitting = 20;  // a warning must do
  EXPECT_THAT(other_heading(found, {0.1, 0.0, 0.0}), IsEmpty());
  found = backwards();
  found.heading_known = false;
  EXPECT_THAT(other_heading(found, {0.1, 0.0, 0.0}), IsEmpty());
}

TEST(UnknownMounting, ADelayIsSaidInOneLine) {
  EXPECT_EQ(text_of(localization::ScanDelay{0.25, {34, 1}}),
            "the stamps of the scans are 0.25 s later than those of the odometry (34 turns fit "
            "that, 1 equal clocks): it is taken out; --scan-delay 0 keeps them");
  EXPECT_THAT(text_of(localization::ScanDelay{-0.1, {5, 0}}), HasSubstr("0.10 s earlier than"));
}

TEST(UnknownMounting, MirroredScansAndMirroredOdometryLookAlike) {
  FoundMounting found = backwards();
  EXPECT_THAT(mirroring(found), IsEmpty());
  found.upside_down = true;
  EXPECT_THAT(mirroring(found), HasSubstr("(29 of 30 motions fit)"));
  EXPECT_THAT(mirroring(found), HasSubstr("--upside-down"));
  EXPECT_THAT(mirroring(found), HasSubstr("odometry: {source: laser}"));
  found.fitting = 20;  // odometry with other faults: the scans go before it
  EXPECT_THAT(mirroring(found), IsEmpty());
}

}  // namespace
}  // namespace topogeo::pipeline
