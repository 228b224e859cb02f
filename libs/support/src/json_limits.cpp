#include "topogeo/support/json_limits.hpp"

#include <cstdint>
#include <vector>

#include <nlohmann/json.hpp>

#include "topogeo/support/format.hpp"

namespace topogeo::support {
namespace {

using Json = nlohmann::json;

/// Builds nothing, and stops at the first exceeded limit.
class LimitCheck final : public nlohmann::json_sax<Json> {
 public:
  explicit LimitCheck(const JsonLimits& limits) : limits_(limits) {}

  /// Empty: within all limits.
  [[nodiscard]] const std::string& excess() const { return excess_; }

  bool null() override { return value(); }
  bool boolean(bool) override { return value(); }
  bool number_integer(std::int64_t) override { return value(); }
  bool number_unsigned(std::uint64_t) override { return value(); }
  bool number_float(double, const std::string&) override { return value(); }
  bool string(std::string&) override { return value(); }
  bool binary(Json::binary_t&) override { return false; }
  bool start_object(std::size_t) override { return enter(); }
  bool start_array(std::size_t) override { return enter(); }
  bool end_object() override { return leave(); }
  bool end_array() override { return leave(); }
  bool key(std::string&) override {
    if (++keys_.back() > limits_.keys) {
      return refuse(fmt::format("more than {} keys in one object", limits_.keys));
    }
    return value();
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;
  }

 private:
  bool refuse(std::string excess) {
    excess_ = std::move(excess);
    return false;
  }
  bool value() {
    if (++values_ <= limits_.values) return true;
    return refuse(fmt::format("more than {} values", limits_.values));
  }
  bool enter() {
    keys_.push_back(0);
    if (keys_.size() > limits_.levels) {
      return refuse(fmt::format("more than {} levels of lists and objects", limits_.levels));
    }
    return value();
  }
  bool leave() {
    keys_.pop_back();
    return true;
  }

  JsonLimits limits_;
  std::vector<std::size_t> keys_;  // of the open objects; lists have none
  std::size_t values_ = 0;
  std::string excess_;
};

}  // namespace

std::string beyond_limits(std::string_view text, const JsonLimits& limits) {
  LimitCheck check(limits);
  static_cast<void>(Json::sax_parse(text, &check));
  return check.excess();
}

}  // namespace topogeo::support
