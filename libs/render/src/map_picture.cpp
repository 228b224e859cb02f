#include "topogeo/render/map_picture.hpp"

#include <memory>
#include <stdexcept>

#include <cairo-svg.h>
#include <cairo.h>
#include <spdlog/fmt/fmt.h>

#include "topogeo/support/atomic_file.hpp"

#include "layout.hpp"
#include "map_drawing.hpp"

namespace topogeo::render {
namespace {

struct DestroySurface {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
};
struct DestroyContext {
  void operator()(cairo_t* cr) const { cairo_destroy(cr); }
};
using Surface = std::unique_ptr<cairo_surface_t, DestroySurface>;
using Context = std::unique_ptr<cairo_t, DestroyContext>;

void check(cairo_status_t status) {
  if (status != CAIRO_STATUS_SUCCESS) {
    throw std::runtime_error(fmt::format("picture: {}", cairo_status_to_string(status)));
  }
}

void check(const MapPicture& picture, const PictureOptions& options) {
  if (options.max_width_px < 400 || options.max_width_px > 16384) {
    throw std::invalid_argument(
        fmt::format("picture of {} px: expected 400 to 16384", options.max_width_px));
  }
  if (picture.stops.size() > picture.local_maps.size()) {
    throw std::invalid_argument(fmt::format("picture with {} stops but {} local maps",
                                            picture.stops.size(), picture.local_maps.size()));
  }
}

/// cairo's way to write into memory.
cairo_status_t append(void* bytes, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

void draw_on(cairo_surface_t* surface, const MapPicture& picture,
             const std::vector<ScanOutline>& outlines, const Layout& layout) {
  check(cairo_surface_status(surface));
  const Context cr(cairo_create(surface));
  draw_map(cr.get(), picture, outlines, layout);
  check(cairo_status(cr.get()));
}

/// cairo numbers its surfaces through the life of the process and writes the number into the SVG.
/// One name for all makes the bytes depend on the picture alone.
std::string without_surface_number(std::string svg) {
  constexpr std::string_view kPrefix = "id=\"surface";
  std::size_t at = 0;
  while ((at = svg.find(kPrefix, at)) != std::string::npos) {
    at += kPrefix.size();
    svg.erase(at, svg.find_first_not_of("0123456789", at) - at);
  }
  return svg;
}

}  // namespace

std::string map_png(const MapPicture& picture, const PictureOptions& options) {
  check(picture, options);
  const auto outlines = outlines_in_map(picture);
  const Layout layout = make_layout(picture, outlines, options);
  const Surface surface(cairo_image_surface_create(
      CAIRO_FORMAT_RGB24, static_cast<int>(layout.width_px), static_cast<int>(layout.height_px)));
  draw_on(surface.get(), picture, outlines, layout);
  std::string png;
  check(cairo_surface_write_to_png_stream(surface.get(), append, &png));
  return png;
}

std::string map_svg(const MapPicture& picture, const PictureOptions& options) {
  check(picture, options);
  const auto outlines = outlines_in_map(picture);
  const Layout layout = make_layout(picture, outlines, options);
  std::string svg;
  {
    const Surface surface(
        cairo_svg_surface_create_for_stream(append, &svg, layout.width_px, layout.height_px));
    cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_PX);
    draw_on(surface.get(), picture, outlines, layout);
    cairo_surface_finish(surface.get());
    check(cairo_surface_status(surface.get()));
  }
  return without_surface_number(std::move(svg));
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
