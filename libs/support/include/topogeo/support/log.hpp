// Messages to the log, spdlog::info and its kin. Include this instead of spdlog's header, which
// would compile the formatting in each file anew; set_up_logging is in logging.hpp.
#pragma once

#include <spdlog/spdlog.h>

#include "topogeo/support/format.hpp"
