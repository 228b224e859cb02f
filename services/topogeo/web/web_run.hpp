// All services and a page, until Ctrl-C: for a simulated robot that waits for goals from the page,
// or only for a stored map.
#pragma once

#include <string>

#include "run/service_run.hpp"

namespace topogeo::cli {

/// Runs the services of `options`, including a web service, until a signal; then returns 0. Without
/// simulation and devices, only the services that show a map run. Throws like ServiceRun, and
/// std::runtime_error when a required service ends.
int run_web(RunOptions options, bool open_browser = false);

}  // namespace topogeo::cli
