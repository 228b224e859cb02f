#include "reproduce/measured.hpp"

#include <algorithm>
#include <cmath>

#include "topogeo/support/format.hpp"

namespace topogeo::reproduce {

const char* to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kEqual:
      return "equal";
    case Verdict::kBetter:
      return "better";
    case Verdict::kDiffers:
      return "differs";
  }
  return "unknown";
}

Verdict verdict_of(const Value& value) {
  if (value.relation == Relation::kShown || !value.expected) return Verdict::kEqual;
  const double more = value.measured - *value.expected;
  if (!std::isfinite(more)) return Verdict::kDiffers;
  if (std::fabs(more) <= value.tolerance) return Verdict::kEqual;
  const bool better = (value.relation == Relation::kSmaller && more < 0.0) ||
                      (value.relation == Relation::kLarger && more > 0.0);
  return better ? Verdict::kBetter : Verdict::kDiffers;
}

Verdict verdict_of(const std::vector<Value>& values) {
  bool compared = false;
  Verdict verdict = Verdict::kEqual;
  for (const Value& value : values) {
    compared |= value.relation != Relation::kShown && value.expected.has_value();
    verdict = std::max(verdict, verdict_of(value));
  }
  return compared ? verdict : Verdict::kDiffers;
}

bool is_time(const Value& value) {
  return value.unit == "ms" || value.unit == "s";
}

std::string text_of(const Means& means) {
  return fmt::format("{}, {}, {} run{}", means.matcher,
                     means.laser_range_m > 0.0 ? fmt::format("{:g} m", means.laser_range_m)
                                               : std::string("no laser"),
                     means.runs, means.runs == 1 ? "" : "s");
}

std::string differences(const std::vector<Value>& values) {
  std::string text;
  for (const Value& value : values) {
    if (verdict_of(value) != Verdict::kDiffers) continue;
    text += fmt::format("{}{}: {} instead of {}", text.empty() ? "" : "; ", value.name,
                        text_of(value.measured, value.unit),
                        text_of(value.expected.value_or(NAN), value.unit));
  }
  return text;
}

std::string text_of(double number, const std::string& unit) {
  if (unit == "yes") return number != 0.0 ? "yes" : "no";
  const std::string digits = number == std::round(number) && std::fabs(number) < 1e9
                                 ? fmt::format("{:.0f}", number + 0.0)
                                 : fmt::format("{:.4g}", number);
  return unit.empty() ? digits : digits + ' ' + unit;
}

}  // namespace topogeo::reproduce
