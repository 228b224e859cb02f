// Legend and scale bar below the map.
#pragma once

#include <string>

#include <cairo.h>

#include "layout.hpp"

namespace topogeo::render {

/// Only what is in the picture is listed.
void draw_legend(cairo_t* cr, const MapPicture& picture, const Layout& layout);

/// Length of 1, 2 or 5 times a power of ten, at most `longest_m`.
double round_length_m(double longest_m);

}  // namespace topogeo::render
