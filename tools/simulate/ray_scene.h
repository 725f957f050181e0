// A mesh in Embree: nearest hits of packets and of single rays.
#pragma once

#include <array>
#include <memory>
#include <optional>

#include "base/error.h"
#include "simulate/mesh.h"

namespace isthmus::sim {

constexpr int kPacket = 8;  ///< rays of one packet; neighbouring columns of a scan line, so coherent

/// Where a ray meets a surface. The range is recomputed in double from the triangle's plane, so it does not depend on
/// the width of the packet or the instruction set.
struct Hit {
  double range_m = 0;
  Vector3d normal = Vector3d::Zero();  ///< unit, outward side of the triangle
  Material material = Material::concrete;
};

/// Unit directions of a packet, structure of arrays; lanes from `count` on are ignored.
struct Packet {
  std::array<float, kPacket> x{}, y{}, z{};
  int count = 0;
};

/// Index of the triangle a ray hits, and its range in single precision.
struct RawHit {
  std::uint32_t triangle = kNone;
  float range_m = 0;
  static constexpr std::uint32_t kNone = 0xFFFFFFFFU;
};

/// Immutable after build(); tracing is safe from any number of threads.
class RayScene {
 public:
  /// Takes the mesh over. Built on one thread, so that the tree (and with it every tie between coincident surfaces) is
  /// the same for any number of threads. An empty mesh is allowed: nothing is ever hit.
  static Result<RayScene> build(Mesh mesh);
  ~RayScene();
  RayScene(RayScene&&) noexcept;
  RayScene& operator=(RayScene&&) noexcept;

  /// Nearest hits in (0, far_m] for the first packet.count lanes.
  void trace(const Vector3d& origin, const Packet& packet, float far_m, std::array<RawHit, kPacket>& hits) const;
  /// Nearest hit in (near_m, far_m].
  [[nodiscard]] std::optional<Hit> trace(const Vector3d& origin, const Vector3d& direction, double near_m,
                                         double far_m) const;
  /// The exact hit of a ray on a triangle that trace() found.
  [[nodiscard]] Hit resolve(const Vector3d& origin, const Vector3d& direction, const RawHit& raw) const;

  [[nodiscard]] const Mesh& mesh() const;

 private:
  struct State;
  explicit RayScene(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace isthmus::sim
