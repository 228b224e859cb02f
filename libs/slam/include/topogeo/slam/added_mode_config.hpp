// An algorithm that a program adds as a value of `localizer.mode`, with its settings: `research/`
// adds that of the Thesis.
#pragma once

#include <memory>

namespace topogeo::support {
class ConfigSchema;
}

namespace topogeo::localization {

struct LocalizerConfig;
class MatchPool;
class Slam;

/// Settings of an added algorithm, and its construction from them.
class AddedMode {
 public:
  AddedMode() = default;
  AddedMode& operator=(const AddedMode&) = delete;
  virtual ~AddedMode() = default;

  [[nodiscard]] virtual std::unique_ptr<AddedMode> copy() const = 0;
  /// Declares the settings.
  virtual void describe(support::ConfigSchema& schema) = 0;
  /// The pool must outlive the result.
  [[nodiscard]] virtual std::unique_ptr<Slam> make(const LocalizerConfig& config,
                                                   MatchPool& pool) const = 0;

 protected:
  AddedMode(const AddedMode&) = default;
};

/// Gives all configurations that are made later a copy of `defaults`. Call it before any threads
/// start.
void add_mode(std::unique_ptr<AddedMode> defaults);

/// The added algorithm of a configuration, copied with it.
class AddedModeConfig {
 public:
  /// The defaults of add_mode(), if it was called.
  AddedModeConfig();
  AddedModeConfig(const AddedModeConfig& other);
  AddedModeConfig(AddedModeConfig&&) noexcept = default;
  AddedModeConfig& operator=(AddedModeConfig other) noexcept;
  ~AddedModeConfig() = default;

  /// Null if the program has no added algorithm.
  [[nodiscard]] AddedMode* get() { return mode_.get(); }
  [[nodiscard]] const AddedMode* get() const { return mode_.get(); }

 private:
  std::unique_ptr<AddedMode> mode_;
};

}  // namespace topogeo::localization
