// Figures of experiments.
#include "topogeo/render/figure.hpp"

#include <limits>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::render {
namespace {

Figure line_figure() {
  FigurePanel panel;
  panel.title = "a line";
  panel.lines.push_back({{{0.0, 0.0}, {1.0, 2.0}}, FigureColour::kRed, 2.0});
  panel.dots.push_back({{{0.5, 1.0}}, FigureColour::kBlue, 4.0});
  panel.texts.push_back({{0.5, 1.5}, "beside it"});
  return {.title = "Figure", .panels = {panel}, .notes = {"a note"}};
}

TEST(FigurePicture, HasItsTextsAndTheSameBytesAgain) {
  const std::string svg = figure_picture(line_figure(), PictureFormat::kSvg);
  EXPECT_THAT(svg, testing::HasSubstr("<svg"));
  EXPECT_EQ(svg, figure_picture(line_figure(), PictureFormat::kSvg));
  Figure other = line_figure();
  other.panels[0].lines[0].points[1].x() = 1.5;
  EXPECT_NE(svg, figure_picture(other, PictureFormat::kSvg));
}

TEST(FigurePicture, PanelsOfOnePointOrNoneAreDrawn) {
  Figure figure;
  figure.panels.resize(5);
  figure.panels[1].dots.push_back({{{3.0, 3.0}}});
  figure.panels[2].equal_scale = false;
  figure.panels[2].dots.push_back({{{3.0, 3.0}}});
  EXPECT_THAT(figure_picture(figure, PictureFormat::kPng), testing::StartsWith("\x89PNG"));
}

TEST(FigurePicture, RefusesNothingAndWhatIsNotFinite) {
  EXPECT_THROW(figure_picture({}, PictureFormat::kSvg), std::invalid_argument);
  Figure figure = line_figure();
  figure.panels[0].dots[0].points[0].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(figure_picture(figure, PictureFormat::kSvg), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::render
