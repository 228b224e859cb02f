// The common drawing routine of both picture formats.
#pragma once

#include <cairo.h>

#include "layout.hpp"

namespace topogeo::render {

/// Fills a white page of the layout's size.
void draw_map(cairo_t* cr, const MapPicture& picture, const std::vector<ScanOutline>& outlines,
              const Layout& layout);

}  // namespace topogeo::render
