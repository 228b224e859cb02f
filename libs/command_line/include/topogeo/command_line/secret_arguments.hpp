// Arguments that other users must not read: `ps` shows those of every program.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace topogeo::command_line {

/// The arguments of a program, copied, with the values of secret options overwritten where `ps`
/// reads them. They were there until then, so that a file or the environment is still the better
/// place.
class SecretArguments {
 public:
  /// For main(): `secret` are options with a value, as "--token"; also "--token=VALUE" is found.
  SecretArguments(int count, char** arguments, std::initializer_list<std::string_view> secret);

  [[nodiscard]] int count() const { return static_cast<int>(texts_.size()); }
  /// With the secrets; valid as long as this object.
  [[nodiscard]] const char* const* values() const { return values_.data(); }
  /// Whether a secret was among them.
  [[nodiscard]] bool had_secret() const { return had_secret_; }

 private:
  void hide(char* value);

  std::vector<std::string> texts_;
  std::vector<const char*> values_;
  bool had_secret_ = false;
};

}  // namespace topogeo::command_line
