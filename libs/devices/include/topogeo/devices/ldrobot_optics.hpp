// Geometry of an LDROBOT LD08 (ROBOTIS LDS-02): its receiver lies beside the axis and looks past
// it, so its distances and angles are not those from the centre of the laser.
//
// Source: ROBOTIS' driver ld08_driver, which moves each point (distance + 5.9 mm, 0.11923 times the
// distance - 20.14 mm) and turns it back by its bearing. No document states these numbers.
#pragma once

namespace topogeo::devices {

/// A reading of an LD08 as seen from the centre of the laser.
struct Ld08Point {
  double range_mm = 0.0;
  double back_deg = 0.0;  ///< against the sense of rotation, from the angle that the packet states
};

/// `distance_mm` > 0 as in a packet.
[[nodiscard]] Ld08Point ld08_point(double distance_mm);
/// The distance that an LD08 sends for a range from its centre; 0 if it is too short.
[[nodiscard]] double ld08_distance_mm(double range_mm);

}  // namespace topogeo::devices
