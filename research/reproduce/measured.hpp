// Measured values of an experiment, the published ones, and the resulting verdict.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace topogeo::reproduce {

/// Relation between a measured value and the expected one.
enum class Relation : std::uint8_t {
  kShown,    ///< not compared: for people
  kEqual,    ///< equal within the tolerance
  kSmaller,  ///< smaller is better
  kLarger,   ///< larger is better
};

/// Source of an expected value.
enum class Origin : std::uint8_t {
  kPrinted,    ///< the publication prints or states it
  kWorkedOut,  ///< worked out by hand from the scene with the publication's equations
};

struct Value {
  std::string name;
  std::string unit{};  ///< "m", "ms", ...; "yes" for a statement that holds (1) or not (0)
  double measured = 0.0;
  std::optional<double> expected{};
  Relation relation = Relation::kShown;
  double tolerance = 0.0;  ///< a difference up to this is ignored
  Origin origin = Origin::kPrinted;
  std::string by{};  ///< what made the value; empty: the means of its row
};

/// The means that made the values of a row.
struct Means {
  std::string matcher =
      "no matching";           ///< "no matching", or form of the fitness, evidence and refinement
  double laser_range_m = 0.0;  ///< limit of the readings that are used; 0: no range sensor
  std::size_t runs = 1;        ///< drives, scans or draws that the values are counted over
};

/// "no matching, 4 m, 1 run".
std::string text_of(const Means& means);

enum class Verdict : std::uint8_t { kEqual, kBetter, kDiffers };

/// "equal", "better", "differs".
const char* to_string(Verdict verdict);

/// A value without an expected one is equal; one that is not finite always differs.
Verdict verdict_of(const Value& value);

/// Differs if any value does or none is compared; otherwise better if any is; otherwise equal.
Verdict verdict_of(const std::vector<Value>& values);

/// A duration of our own work, which depends on the machine.
bool is_time(const Value& value);

/// The differing values as one line; empty if there are none.
std::string differences(const std::vector<Value>& values);

/// A number as shown in tables: "yes" or "no" for a statement, otherwise at most four significant
/// digits and the unit.
std::string text_of(double number, const std::string& unit);

struct Table {
  std::string title;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

}  // namespace topogeo::reproduce
