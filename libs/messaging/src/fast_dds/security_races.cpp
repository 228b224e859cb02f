// Fast DDS 2.9.1 prepares the handshake with a new participant in a proxy that all its receiving
// threads share without a lock (SecurityManager::match_builtin_endpoints; later versions take one
// from a pool). When two participants are discovered at once one of them is never matched, and the
// two processes never authenticate each other: half of the starts of eight services. This takes the
// function's place in the library, which calls it through its symbol, and lets one thread in at a
// time. Should a library have no such function, nothing calls this one.
#include <mutex>

#include "../security.hpp"
#include "library_function.hpp"

namespace {

constexpr const char* kSymbol =
    "_ZN8eprosima8fastrtps4rtps8security15SecurityManager23match_builtin_endpointsERKNS1_"
    "20ParticipantProxyDataE";

}  // namespace

// NOLINTNEXTLINE: the name of a member function of the library
extern "C" void topogeo_match_builtin_endpoints(void* manager, const void* participant) __asm__(
    "_ZN8eprosima8fastrtps4rtps8security15SecurityManager23match_builtin_endpointsERKNS1_"
    "20ParticipantProxyDataE");

extern "C" void topogeo_match_builtin_endpoints(void* manager, const void* participant) {
  using Function = void (*)(void*, const void*);
  static std::mutex mutex;
  static const auto next = topogeo::messaging::library_function<Function>(kSymbol);
  if (next == nullptr) return;
  const std::lock_guard lock(mutex);
  next(manager, participant);
}

namespace topogeo::messaging {

void keep_security_races_away() {}

}  // namespace topogeo::messaging
