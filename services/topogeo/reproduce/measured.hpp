// What an experiment measures, what is published of it, and the verdict that follows from both.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace topogeo::reproduce {

/// How a measured value is compared with the expected one.
enum class Relation : std::uint8_t {
  kShown,    ///< not at all: for people
  kEqual,    ///< the same, within the tolerance
  kSmaller,  ///< smaller is better
  kLarger,   ///< larger is better
};

/// Where an expected value comes from.
enum class Origin : std::uint8_t {
  kPrinted,    ///< the publication prints or states it
  kWorkedOut,  ///< follows from the scene by the publication's equations, worked out by hand
};

struct Value {
  std::string name;
  std::string unit{};  ///< "m", "ms", ...; "yes" for a statement that holds (1) or not (0)
  double measured = 0.0;
  std::optional<double> expected{};
  Relation relation = Relation::kShown;
  double tolerance = 0.0;  ///< a difference up to this is none
  Origin origin = Origin::kPrinted;
};

enum class Verdict : std::uint8_t { kEqual, kBetter, kDiffers };

/// "equal", "better", "differs".
const char* to_string(Verdict verdict);

/// A value without an expected one is equal; one that is not finite differs from any.
Verdict verdict_of(const Value& value);

/// Differs if any value does or none is compared; else better if any is; else equal.
Verdict verdict_of(const std::vector<Value>& values);

/// The values that differ, as one line; empty if none does.
std::string differences(const std::vector<Value>& values);

/// A number as tables show it: "yes" and "no" for a statement, else at most four significant digits
/// and the unit.
std::string text_of(double number, const std::string& unit);

struct Table {
  std::string title;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

}  // namespace topogeo::reproduce
