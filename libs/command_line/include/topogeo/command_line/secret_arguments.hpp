// Hides arguments that other users must not read: `ps` shows those of every program.
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace topogeo::command_line {

/// A copy of a program's arguments; the values of secret options are overwritten where `ps` reads
/// them. They are visible until then, so a file or the environment is still the better place.
class SecretArguments {
 public:
  /// For main(): `secret` are options with a value, such as "--token"; "--token=VALUE" is also
  /// found.
  SecretArguments(int count, char** arguments, std::initializer_list<std::string_view> secret);

  [[nodiscard]] int count() const { return static_cast<int>(texts_.size()); }
  /// Includes the secrets; valid as long as this object.
  [[nodiscard]] const char* const* values() const { return values_.data(); }
  /// Whether the arguments contained a secret.
  [[nodiscard]] bool had_secret() const { return had_secret_; }

 private:
  void hide(char* value);

  std::vector<std::string> texts_;
  std::vector<const char*> values_;
  bool had_secret_ = false;
};

}  // namespace topogeo::command_line
