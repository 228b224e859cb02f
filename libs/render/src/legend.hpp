// Legend and scale bar below the map.
#pragma once

#include <cairo.h>

#include "layout.hpp"

namespace topogeo::render {

/// Lists only the contents of the picture.
void draw_legend(cairo_t* cr, const MapPicture& picture, const Layout& layout);

}  // namespace topogeo::render
