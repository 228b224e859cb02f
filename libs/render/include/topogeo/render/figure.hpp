// Figures of experiments: panels side by side, each with lines, dots and texts in its own axes.
//
// Not a plotting library: covers only what the pictures of a scan, a match, a map or a route do not
// show.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/render/map_picture.hpp"
#include "topogeo/render/picture_format.hpp"

namespace topogeo::render {

/// Hues that colour-blind readers can distinguish; the pale ones are for areas.
enum class FigureColour : std::uint8_t {
  kBlack,
  kGrey,
  kPaleGrey,
  kGreen,
  kBlue,
  kRed,
  kOrange,
  kSky,
  kViolet,
  kTeal,
};

/// Points are (across, up) in the units of the panel.
struct FigureLine {
  std::vector<Eigen::Vector2d> points{};
  FigureColour colour = FigureColour::kBlack;
  double width_px = 1.5;
  bool dashed = false;
  bool closed = false;
  bool filled = false;  ///< only the area, below everything that is not filled
};

struct FigureDots {
  std::vector<Eigen::Vector2d> points{};
  FigureColour colour = FigureColour::kBlack;
  double radius_px = 2.0;
  bool ring = false;  ///< white inside
};

struct FigureText {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  std::string text{};
  FigureColour colour = FigureColour::kBlack;
};

struct FigureExtent {
  Eigen::Vector2d low = Eigen::Vector2d::Zero();
  Eigen::Vector2d high = Eigen::Vector2d::Ones();
};

struct FigurePanel {
  std::string title{};
  std::string across = "right (m)";
  std::string up = "forward (m)";
  bool equal_scale = true;
  std::optional<FigureExtent> extent{};  ///< none: around all lines, dots and texts
  std::vector<FigureLine> lines{};
  std::vector<FigureDots> dots{};
  std::vector<FigureText> texts{};
};

struct Figure {
  std::string title{};
  std::vector<FigurePanel> panels{};
  std::uint32_t columns = 0;         ///< panels in a row; 0: all up to three
  std::vector<std::string> notes{};  ///< lines below the panels
};

/// The bytes of the file, `max_width_px` wide. The same figure gives the same SVG bytes. Throws
/// std::invalid_argument for a width out of range, a figure without panels or a number that is not
/// finite.
std::string figure_picture(const Figure& figure, PictureFormat format,
                           const PictureOptions& options = {});

}  // namespace topogeo::render
