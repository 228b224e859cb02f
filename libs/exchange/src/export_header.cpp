#include "topogeo/exchange/export_header.hpp"

#include <chrono>
#include <string_view>

#include "topogeo/support/format.hpp"

namespace topogeo::exchange {

std::string utc_text(std::int64_t stamp_ns) {
  using namespace std::chrono;
  const sys_time<nanoseconds> time{nanoseconds(stamp_ns)};
  const auto day = floor<days>(time);
  const year_month_day date(day);
  const hh_mm_ss clock(floor<milliseconds>(time - day));
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                     clock.hours().count(), clock.minutes().count(), clock.seconds().count(),
                     clock.subseconds().count());
}

std::string plain_id(const std::string& text) {
  constexpr std::string_view kAllowed =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-.:";
  std::string id = text;
  for (char& c : id) {
    if (kAllowed.find(c) == std::string_view::npos) c = '_';
  }
  return id.empty() ? "_" : id;
}

}  // namespace topogeo::exchange
