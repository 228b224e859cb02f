#include "page.hpp"

#include <memory>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <cairo-svg.h>

#include "topogeo/support/format.hpp"
#include "topogeo/support/lower_case.hpp"

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

/// Appends cairo's output to the std::string `bytes`; a cairo_write_func_t.
cairo_status_t append(void* bytes, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(bytes)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

void draw_on(cairo_surface_t* surface, const std::function<void(cairo_t*)>& draw) {
  check(cairo_surface_status(surface));
  const Context cr(cairo_create(surface));
  draw(cr.get());
  check(cairo_status(cr.get()));
}

/// cairo numbers its surfaces over the life of the process and writes the number into the SVG. A
/// fixed name makes the bytes depend on the picture only.
std::string without_surface_number(std::string svg) {
  constexpr std::string_view kPrefix = "id=\"surface";
  std::size_t at = 0;
  while ((at = svg.find(kPrefix, at)) != std::string::npos) {
    at += kPrefix.size();
    svg.erase(at, svg.find_first_not_of("0123456789", at) - at);
  }
  return svg;
}

std::string draw_png(std::uint32_t width_px, std::uint32_t height_px,
                     const std::function<void(cairo_t*)>& draw) {
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(width_px),
                                                   static_cast<int>(height_px)));
  draw_on(surface.get(), draw);
  std::string png;
  check(cairo_surface_write_to_png_stream(surface.get(), append, &png));
  return png;
}

std::string draw_svg(std::uint32_t width_px, std::uint32_t height_px,
                     const std::function<void(cairo_t*)>& draw) {
  std::string svg;
  {
    const Surface surface(cairo_svg_surface_create_for_stream(append, &svg, width_px, height_px));
    cairo_svg_surface_set_document_unit(surface.get(), CAIRO_SVG_UNIT_PX);
    draw_on(surface.get(), draw);
    cairo_surface_finish(surface.get());
    check(cairo_surface_status(surface.get()));
  }
  return without_surface_number(std::move(svg));
}

}  // namespace

PictureFormat picture_format(const std::filesystem::path& path) {
  const std::string ending = support::lower_case(path.extension().string());
  if (ending == ".png") return PictureFormat::kPng;
  if (ending == ".svg") return PictureFormat::kSvg;
  throw std::invalid_argument(
      fmt::format("{}: expected a file name that ends in .png or .svg", path.string()));
}

void check(const PictureOptions& options) {
  if (options.max_width_px < 400 || options.max_width_px > 16384) {
    throw std::invalid_argument(
        fmt::format("picture of {} px: expected 400 to 16384", options.max_width_px));
  }
}

std::string draw_page(PictureFormat format, std::uint32_t width_px, std::uint32_t height_px,
                      const std::function<void(cairo_t*)>& draw) {
  return format == PictureFormat::kPng ? draw_png(width_px, height_px, draw)
                                       : draw_svg(width_px, height_px, draw);
}

}  // namespace topogeo::render
