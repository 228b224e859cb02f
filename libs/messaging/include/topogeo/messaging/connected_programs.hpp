// Finds the programs that are connected to every topic that they read from this one.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "topogeo/messaging/writer.hpp"

namespace topogeo::messaging {

/// The readers of a program connect one by one, and messages sent on a volatile topic before that
/// are lost. A reader also announces the other topics that its program reads
/// (ReaderOptions::read_with). A program is connected once this holds for its readers of all of
/// those topics that are written here.
class ConnectedPrograms {
 public:
  /// Programs that read the topic of `counted`; `others` are the other writers of this program.
  template <class T, class... Others>
  explicit ConnectedPrograms(const Writer<T>& counted, const Writer<Others>&... others)
      : counted_(counted.core()), others_{others.core()...} {}

  template <class T>
  void include(const Writer<T>& other) {
    others_.push_back(other.core());
  }

  [[nodiscard]] int count() const;
  /// The topics that some programs are not connected to yet, as readable text: "odometry".
  [[nodiscard]] std::string missing() const;

 private:
  [[nodiscard]] std::vector<std::string> missing_of(const Handle& reader) const;

  std::shared_ptr<detail::WriterCore> counted_;
  std::vector<std::shared_ptr<detail::WriterCore>> others_;
};

}  // namespace topogeo::messaging
