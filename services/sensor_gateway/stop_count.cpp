#include "stop_count.hpp"

#include <utility>

namespace topogeo::sensor_gateway {

void StopCount::halt(const messaging::Handle& writer) {
  if (halted_by_ != writer) before_halts_ = number_;
  halted_by_ = writer;
  ++number_;
}

void StopCount::emergency_stop(bool holds) {
  if (std::exchange(emergency_stop_, holds) || !holds) return;
  halted_by_.reset();
  ++number_;
}

bool StopCount::may_release(const messaging::Handle& writer, std::uint64_t seen) const {
  return seen == number_ || (halted_by_ == writer && seen >= before_halts_ && seen < number_);
}

}  // namespace topogeo::sensor_gateway
