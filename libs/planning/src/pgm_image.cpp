#include "topogeo/planning/pgm_image.hpp"

#include <cctype>
#include <stdexcept>

#include "topogeo/support/foreign_file.hpp"

namespace topogeo::planning {
namespace {

constexpr int kMostAlong = 20000;  // as for a grid, see occupancy_grid.cpp
constexpr int kMostDepth = 255;    // of one byte per pixel, as in all map files

class PgmParser {
 public:
  PgmParser(std::string_view bytes, const std::string& source) : bytes_(bytes), source_(source) {}

  PgmImage parse() {
    const std::string_view magic = bytes_.substr(0, 2);
    if (magic != "P2" && magic != "P5") fail("not a PGM image: it must begin with P2 or P5");
    at_ = 2;
    PgmImage image;
    image.width = number("width", 1, kMostAlong);
    image.height = number("height", 1, kMostAlong);
    image.depth = number("maximum value", 1, kMostDepth);
    const auto count =
        static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    if (count > support::kMostPixels) {
      fail("has " + std::to_string(count) + " pixels, expected at most " +
           std::to_string(support::kMostPixels));
    }
    if (magic == "P2") {
      read_text(image, count);
    } else {
      read_bytes(image, count);
    }
    return image;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(source_ + ": " + what);
  }

  void skip_blanks() {
    while (at_ < bytes_.size()) {
      if (bytes_[at_] == '#') {
        while (at_ < bytes_.size() && bytes_[at_] != '\n') ++at_;
      } else if (std::isspace(static_cast<unsigned char>(bytes_[at_])) != 0) {
        ++at_;
      } else {
        return;
      }
    }
  }

  int number(const std::string& field, int low, int high) {
    skip_blanks();
    const std::size_t begin = at_;
    long value = 0;
    while (at_ < bytes_.size() && std::isdigit(static_cast<unsigned char>(bytes_[at_])) != 0) {
      value = value * 10 + (bytes_[at_] - '0');
      if (value > high) break;
      ++at_;
    }
    if (at_ == begin && at_ == bytes_.size()) fail(field + " is missing: the file is cut short");
    if (at_ == begin || value < low || value > high) {
      fail(field + " is not a whole number from " + std::to_string(low) + " to " +
           std::to_string(high));
    }
    return static_cast<int>(value);
  }

  void read_text(PgmImage& image, std::size_t count) {
    // A pixel takes at least a digit and a blank.
    if (bytes_.size() - at_ < 2 * count - 1) fail_short(count);
    image.pixels.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
      image.pixels.push_back(
          static_cast<std::uint8_t>(number("pixel " + std::to_string(i), 0, image.depth)));
    }
  }

  void read_bytes(PgmImage& image, std::size_t count) {
    if (at_ >= bytes_.size() || std::isspace(static_cast<unsigned char>(bytes_[at_])) == 0) {
      fail("expected a blank between the maximum value and the pixels");
    }
    ++at_;
    // A header with the line ends of Windows has a blank too many. In a file without a byte to
    // spare it is the first pixel.
    const bool other_end = bytes_[at_ - 1] == '\r' && bytes_.substr(at_).starts_with('\n');
    if (other_end && bytes_.size() - at_ > count) ++at_;
    if (bytes_.size() - at_ < count) fail_short(count);
    image.pixels.assign(bytes_.begin() + static_cast<std::ptrdiff_t>(at_),
                        bytes_.begin() + static_cast<std::ptrdiff_t>(at_ + count));
    for (std::size_t i = 0; i < count; ++i) {
      if (image.pixels[i] <= image.depth) continue;
      fail("pixel " + std::to_string(i) + " is " + std::to_string(image.pixels[i]) +
           ", expected 0 to " + std::to_string(image.depth));
    }
  }

  [[noreturn]] void fail_short(std::size_t count) const {
    fail("is cut short: expected " + std::to_string(count) + " pixels");
  }

  std::string_view bytes_;
  const std::string& source_;
  std::size_t at_ = 0;
};

}  // namespace

PgmImage parse_pgm(std::string_view bytes, const std::string& source) {
  return PgmParser(bytes, source).parse();
}

std::string pgm_bytes(const PgmImage& image, bool as_text) {
  std::string bytes = std::string(as_text ? "P2" : "P5") + '\n' + std::to_string(image.width) +
                      ' ' + std::to_string(image.height) + '\n' + std::to_string(image.depth) +
                      '\n';
  if (!as_text) {
    bytes.append(image.pixels.begin(), image.pixels.end());
    return bytes;
  }
  const auto width = static_cast<std::size_t>(image.width);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    bytes.append(std::to_string(image.pixels[i]));
    bytes.push_back((i + 1) % width == 0 ? '\n' : ' ');
  }
  return bytes;
}

}  // namespace topogeo::planning
