#include <functional>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "axes.hpp"
#include "labels.hpp"
#include "page.hpp"
#include "pixels.hpp"

namespace topogeo::render {
namespace {

Pixels drawn(const std::function<void(cairo_t*)>& draw) {
  return Pixels(draw_page(PictureFormat::kPng, 100, 80, [&](cairo_t* cr) {
    start_page(cr);
    set_colour(cr, kInk);
    draw(cr);
  }));
}

TEST(TickStep, IsTheLeastRoundOneWithFewEnoughTicks) {
  EXPECT_DOUBLE_EQ(tick_step(10.0, 10.0), 1.0);
  EXPECT_DOUBLE_EQ(tick_step(10.1, 10.0), 2.0);
  EXPECT_DOUBLE_EQ(tick_step(21.0, 10.0), 5.0);
  EXPECT_DOUBLE_EQ(tick_step(0.7, 8.0), 0.1);
}

TEST(Ticks, AreTheMultiplesInTheRange) {
  std::vector<double> ticks;
  for_each_tick(-92.0, 92.0, 30.0, [&](double value) { ticks.push_back(value); });
  EXPECT_EQ(ticks, (std::vector<double>{-90.0, -60.0, -30.0, 0.0, 30.0, 60.0, 90.0}));
}

TEST(Labels, StandBesideTheirMarkAndKeepOffEachOther) {
  const Rect page{0.0, 0.0, 100.0, 80.0};
  const Pixels alone = drawn([&](cairo_t* cr) {
    Labels labels;
    labels.block({50.0, 40.0}, 5.0);
    labels.draw(cr, "8", {50.0, 40.0}, 6.0, 12.0, page, false);
  });
  const auto first = alone.find(kInk, page);
  ASSERT_FALSE(first.empty());
  for (const Eigen::Vector2d& at : first) {
    EXPECT_GT(at.x(), 54.0);  // to the right above the mark
    EXPECT_LT(at.y(), 36.0);
  }
  const Pixels two = drawn([&](cairo_t* cr) {
    Labels labels;
    labels.draw(cr, "8", {50.0, 40.0}, 6.0, 12.0, page, false);
    labels.draw(cr, "8", {50.0, 40.0}, 6.0, 12.0, page, false);
  });
  EXPECT_EQ(two.count(kInk), 2 * alone.count(kInk));
}

TEST(Labels, AreLeftOutWhereNothingIsFreeUnlessTheyMustBeThere) {
  for (const bool always : {false, true}) {
    const Pixels pixels = drawn([&](cairo_t* cr) {
      Labels labels;
      labels.block({50.0, 40.0}, 45.0);
      labels.draw(cr, "8", {50.0, 40.0}, 6.0, 12.0, {0.0, 0.0, 100.0, 80.0}, always);
    });
    EXPECT_EQ(pixels.count(kInk) > 0, always);
  }
}

TEST(PictureFormat, FollowsTheEndingOfTheName) {
  EXPECT_EQ(picture_format("a/b.png"), PictureFormat::kPng);
  EXPECT_EQ(picture_format("b.SVG"), PictureFormat::kSvg);
  for (const char* name : {"b.jpg", "png", "b.png/", ""}) {
    EXPECT_THROW((void)picture_format(name), std::invalid_argument) << name;
  }
}

TEST(Page, TooHighForCairoIsAnError) {
  EXPECT_THROW((void)draw_page(PictureFormat::kPng, 400, 40000, start_page), std::runtime_error);
}

}  // namespace
}  // namespace topogeo::render
