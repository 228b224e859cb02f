// All services and a page, until Ctrl-C: of a simulated robot that stands until the page sends it,
// or of a stored map alone.
#pragma once

#include <string>

#include "service_run.hpp"

namespace topogeo::cli {

/// Runs the services of `options`, which has a web service, until a signal comes; 0 then. Without a
/// simulation and devices there are only those that show a map. Throws like ServiceRun, and
/// std::runtime_error when a service ends that is needed.
int run_web(RunOptions options, bool open_browser = false);

}  // namespace topogeo::cli
