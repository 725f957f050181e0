// The fields of an E57 scan that points are made of, read side by side.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "io/e57/e57_stream.h"
#include "io/scan_reader.h"

namespace isthmus::io {

class E57Columns {
 public:
  /// Fails if the prototype has no three coordinates. Starts at record 0.
  static Result<E57Columns> of(const E57Scan& scan, const E57Section& section, const std::string& where);

  [[nodiscard]] bool is_spherical() const { return spherical_; }
  [[nodiscard]] bool has_intensity() const { return streams_[kIntensity].has_value(); }
  [[nodiscard]] bool has_colour() const { return streams_[kRed].has_value(); }

  /// Reads the next n records in place of those read before.
  Result<void> read(E57Packets& packets, std::size_t n);
  [[nodiscard]] std::size_t size() const { return size_; }  ///< records read last

  /// Of record i of those read last.
  [[nodiscard]] bool is_valid(std::size_t i) const { return !streams_[kInvalid] || values_[kInvalid][i] == 0.0; }
  [[nodiscard]] Eigen::Vector3d position(std::size_t i) const;
  void append(std::size_t i, const Eigen::Vector3d& origin, PointChunk& chunk) const;

  /// Colours without declared limits: values up to 1 of float fields are 0..1, none above 255 is 0..255, else 16 bits.
  void choose_colour_scale(double largest);
  [[nodiscard]] double largest_colour() const;  ///< of the records read last

  /// Calls visit(stream) for the fields that take space.
  template <class Visit>
  void each_stream(const Visit& visit) {
    for (auto& stream : streams_) {
      if (stream) visit(*stream);
    }
  }

 private:
  enum Slot : std::size_t { kX, kY, kZ, kInvalid, kIntensity, kNoIntensity, kRed, kGreen, kBlue, kNumSlots };

  bool spherical_ = false;
  std::array<std::optional<E57Stream>, kNumSlots> streams_;
  std::array<std::vector<double>, kNumSlots> values_;
  std::size_t size_ = 0;
  std::array<E57Limits, 3> colour_limits_;
  bool float_colour_ = false;
};

}  // namespace isthmus::io
