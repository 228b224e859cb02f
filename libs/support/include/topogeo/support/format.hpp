// Text formatting with fmt. Include this instead of fmt's own headers: the function that all
// formatting into buffers and all logging goes through takes seconds to compile, and is compiled
// once, in this library.
#pragma once

#include <fmt/format.h>

extern template void fmt::detail::vformat_to<char>(fmt::detail::buffer<char>&, fmt::string_view,
                                                   fmt::format_args, fmt::detail::locale_ref);
