#include "topogeo/render/contact_sheet.hpp"

#include <stdexcept>

#include <gmock/gmock.h>

#include "pixels.hpp"
#include "sample_scan.hpp"

namespace topogeo::render {
namespace {

TEST(ContactSheet, HasAThumbnailForEachScanInRows) {
  const std::vector<ScanView> one(1, view_of(corridor_scan(true, true)));
  const std::vector<ScanView> six(6, one.front());
  const std::vector<ScanView> seven(7, one.front());
  const Pixels small(contact_sheet(one, "hall", PictureFormat::kPng));
  const Pixels row(contact_sheet(six, "hall", PictureFormat::kPng));
  const Pixels two_rows(contact_sheet(seven, "hall", PictureFormat::kPng));
  EXPECT_EQ(row.width(), 1600);
  EXPECT_GT(two_rows.height(), row.height() + 150);
  // Legend and title appear once.
  const int thumbnail = two_rows.count(kBranch) - row.count(kBranch);
  EXPECT_GT(thumbnail, 50);
  EXPECT_NEAR(row.count(kBranch) - small.count(kBranch), 5 * thumbnail, 3 * thumbnail);
}

TEST(ContactSheet, DrawsVirtualAndBlindScans) {
  const std::vector<ScanView> views{view_of(corridor_scan(true, false)), view_of(blind_scan(1)),
                                    view_of(blind_scan(361))};
  EXPECT_GT(Pixels(contact_sheet(views, "hall", PictureFormat::kPng)).count(kVirtualBranch), 100);
}

TEST(ContactSheet, IsTheSameBytesEachTime) {
  const std::vector<ScanView> views(3, view_of(corridor_scan(true, true)));
  EXPECT_TRUE(contact_sheet(views, "hall", PictureFormat::kSvg) ==
              contact_sheet(views, "hall", PictureFormat::kSvg));
}

TEST(ContactSheet, RefusesNoneTooManyAndOddWidths) {
  std::vector<ScanView> views;
  EXPECT_THROW((void)contact_sheet(views, "", PictureFormat::kPng), std::invalid_argument);
  views.resize(kMostThumbnails + 1);
  EXPECT_THROW((void)contact_sheet(views, "", PictureFormat::kPng), std::invalid_argument);
  views.resize(1);
  EXPECT_THROW((void)contact_sheet(views, "", PictureFormat::kPng, {.max_width_px = 20000}),
               std::invalid_argument);
}

TEST(ContactSheet, OfTheMostScansIsAPng) {
  const std::vector<ScanView> views(kMostThumbnails, view_of(blind_scan(1)));
  EXPECT_GT(Pixels(contact_sheet(views, "hall", PictureFormat::kPng)).height(), 10000);
}

}  // namespace
}  // namespace topogeo::render
