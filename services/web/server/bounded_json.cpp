#include "server/bounded_json.hpp"

#include <stdexcept>
#include <string>
#include <vector>

namespace topogeo::web {
namespace {

/// Stops at what is too much.
class Limits final : public nlohmann::json_sax<Json> {
 public:
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(std::int64_t) override { return true; }
  bool number_unsigned(std::uint64_t) override { return true; }
  bool number_float(double, const std::string&) override { return true; }
  bool string(std::string&) override { return true; }
  bool binary(Json::binary_t&) override { return false; }
  bool start_object(std::size_t) override { return enter(); }
  bool key(std::string&) override { return ++keys_.back() <= kMostKeys; }
  bool end_object() override { return leave(); }
  bool start_array(std::size_t) override { return enter(); }
  bool end_array() override { return leave(); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;
  }

 private:
  bool enter() {
    keys_.push_back(0);
    return keys_.size() <= kMostLevels;
  }
  bool leave() {
    keys_.pop_back();
    return true;
  }
  std::vector<std::size_t> keys_;  // of the objects that are open; lists have none
};

}  // namespace

Json parse_bounded(std::string_view text) {
  Limits limits;
  if (!Json::sax_parse(text, &limits)) return Json(Json::value_t::discarded);
  return Json::parse(text, nullptr, false);
}

Json object_of(std::string_view text) {
  Json json = parse_bounded(text);
  if (!json.is_object()) {
    throw std::invalid_argument("expected a JSON object of at most 64 keys");
  }
  return json;
}

}  // namespace topogeo::web
