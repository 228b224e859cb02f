// Names of elements in profiles files, which differ between Fast DDS 2.9.1 and 3.
#pragma once

#include <string>

#include "topogeo/messaging/detail/fast_dds.hpp"

namespace topogeo::messaging {

/// The text of a profiles file with the elements of <times> named as in the library: our file has
/// the names of Fast DDS 2.9.1.
std::string with_names_of_library(std::string text);

}  // namespace topogeo::messaging
