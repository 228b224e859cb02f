#include "topogeo/render/match_picture.hpp"

#include <stdexcept>

#include <gmock/gmock.h>

#include "canvas.hpp"
#include "pixels.hpp"
#include "sample_scan.hpp"

namespace topogeo::render {
namespace {

using ::testing::HasSubstr;

class MatchPictureTest : public ::testing::Test {
 protected:
  MatchPictureTest() {
    picture_.reference = &view_.map;
    picture_.query = &view_.map;
    picture_.T_predicted = {1.0, 0.0, 0.0};
    picture_.ellipse_major_m = 0.8;
    picture_.ellipse_minor_m = 0.4;
    picture_.half_width_m = {0.8, 0.4};
    picture_.solutions = {{0.5, 0.1, 0.0}, {1.2, 0.2, 0.1}};
    picture_.found = true;
    picture_.T_found = {0.5, 0.1, 0.0};
    picture_.title = "stop 2 searched in stop 1";
    picture_.lines = {"verdict: accepted"};
  }

  ScanView view_ = view_of(corridor_scan(true, true));
  MatchPicture picture_;
};

TEST_F(MatchPictureTest, ShowsBothMapsAndWhatWasSearched) {
  const Pixels pixels(match_picture(picture_, PictureFormat::kPng));
  ASSERT_EQ(pixels.width(), 1600);
  const Rect maps{60.0, 66.0, 720.0, 720.0};
  const Rect search{860.0, 66.0, 720.0, 720.0};
  EXPECT_GT(pixels.find(kLaserPoints, maps).size(), 100U);
  EXPECT_GT(pixels.find(kCorrected, maps).size(), 100U);
  EXPECT_GT(pixels.find(kBranch, search).size(), 20U) << "solutions";
  EXPECT_GT(pixels.find(kOdometry, search).size(), 300U) << "rectangle and ellipse";
  EXPECT_GT(pixels.find(kCorrected, search).size(), 20U) << "the refined pose";
}

TEST_F(MatchPictureTest, TheQueryLiesWhereItWasFound) {
  // The red points move with the pose, the grey ones do not.
  const std::string svg = match_picture(picture_, PictureFormat::kSvg);
  EXPECT_EQ(match_picture(picture_, PictureFormat::kSvg), svg);
  picture_.T_found.x_m += 0.3;
  EXPECT_NE(match_picture(picture_, PictureFormat::kSvg), svg);
  picture_.found = false;
  const Pixels without(match_picture(picture_, PictureFormat::kPng));
  EXPECT_EQ(without.find(kCorrected, Rect{860.0, 66.0, 720.0, 720.0}).size(), 0U);
}

TEST_F(MatchPictureTest, RefusesAWidthOutOfRange) {
  EXPECT_THROW(match_picture(picture_, PictureFormat::kPng, {.max_width_px = 100}),
               std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::render
