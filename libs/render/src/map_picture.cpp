#include "topogeo/render/map_picture.hpp"

#include <stdexcept>

#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/format.hpp"

#include "draw_map.hpp"
#include "layout.hpp"
#include "page.hpp"

namespace topogeo::render {
namespace {

void check_picture(const MapPicture& picture) {
  if (picture.stops.size() > picture.local_maps.size()) {
    throw std::invalid_argument(fmt::format("picture with {} stops but {} local maps",
                                            picture.stops.size(), picture.local_maps.size()));
  }
}

std::string map_bytes(const MapPicture& picture, const PictureOptions& options,
                      PictureFormat format) {
  check(options);
  check_picture(picture);
  const auto outlines = outlines_in_map(picture);
  const Layout layout = make_layout(picture, outlines, options);
  return draw_page(format, layout.width_px, layout.height_px,
                   [&](cairo_t* cr) { draw_map(cr, picture, outlines, layout); });
}

}  // namespace

std::string map_png(const MapPicture& picture, const PictureOptions& options) {
  return map_bytes(picture, options, PictureFormat::kPng);
}

std::string map_svg(const MapPicture& picture, const PictureOptions& options) {
  return map_bytes(picture, options, PictureFormat::kSvg);
}

void draw_map_png(const std::filesystem::path& path, const MapPicture& picture,
                  const PictureOptions& options) {
  support::write_file_atomically(path, map_png(picture, options));
}

void draw_map_svg(const std::filesystem::path& path, const MapPicture& picture,
                  const PictureOptions& options) {
  support::write_file_atomically(path, map_svg(picture, options));
}

}  // namespace topogeo::render
