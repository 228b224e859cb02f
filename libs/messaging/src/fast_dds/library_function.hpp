// A function of the middleware that it does not offer: one that ours takes the place of, or needs.
#pragma once

#include <dlfcn.h>

namespace topogeo::messaging {

template <class Function>
Function library_function(const char* symbol) {
  // The next definition after those of the program is that of the library.
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, symbol));  // NOLINT(*-reinterpret-cast)
}

}  // namespace topogeo::messaging
