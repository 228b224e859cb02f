// Text formatting with fmt. Include this instead of fmt's own headers: the function behind all
// formatting into buffers and all logging takes seconds to compile, so it is compiled once, in this
// library.
#pragma once

#include <fmt/format.h>

extern template void fmt::detail::vformat_to<char>(fmt::detail::buffer<char>&, fmt::string_view,
                                                   fmt::format_args, fmt::detail::locale_ref);
