// Log set-up of a process: name of the process, level, to stderr.
#pragma once

#include <string_view>

namespace topogeo::support {

/// Makes spdlog's default logger write to stderr as "time level name: text", one line each, without
/// control characters. `level` is one of trace, debug, info, warning, error, off. Throws
/// std::invalid_argument for any other. Call once, at the start of a program.
void set_up_logging(std::string_view name, std::string_view level);

}  // namespace topogeo::support
