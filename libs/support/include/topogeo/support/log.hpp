// Log messages, spdlog::info and its kin. Include this instead of spdlog's header, which would
// compile the formatting again in each file; set_up_logging is in logging.hpp.
#pragma once

#include <spdlog/spdlog.h>

#include "topogeo/support/format.hpp"
