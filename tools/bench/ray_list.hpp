// SPDX-License-Identifier: AGPL-3.0-or-later
// Rays, in the two forms in which tracers take them, and what is asked of them.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "tetfmt/traverse.hpp"

namespace tetbench {

/// A ray as peers know it: the origin is a point of float32 numbers, which a place on a surface is rounded
/// to.
struct PeerRay {
  tetfmt::Vec3f origin, direction;
  float t_min = 0, t_max = std::numeric_limits<float>::infinity();
};

/// Sixteen of them, component by component, as packets want it; single rays read it at no cost.
struct alignas(64) Packet {
  static constexpr std::size_t kSize = 16;
  using Lanes = std::array<float, kSize>;
  Lanes origin_x{}, origin_y{}, origin_z{}, t_min{}, direction_x{}, direction_y{}, direction_z{}, t_max{};
};

/// Rays from places (a Location each) in structure-of-arrays form, and the same rays for peers.
struct RayList {
  bool occlusion = false;          ///< asked: is anything in the way; else: what is met first
  bool coherent = true;            ///< rays that follow each other are close to each other
  std::optional<double> distance;  ///< of the camera, in tenths of the surface's largest extent

  std::vector<tetfmt::Location> places;
  /// Of each ray: where it starts, its direction, and where it ends: at t_max or, if `to` is not empty, at a
  /// place (then directions count for peers only).
  std::vector<std::uint32_t> from, to;
  std::vector<tetfmt::Vec3f> directions;
  std::vector<float> t_max;
  std::vector<Packet> packets;  ///< the last one is filled up with rays that hit nothing

  std::size_t size() const { return directions.size(); }
  bool one_origin() const { return places.size() == 1 && to.empty(); }
  bool unbounded() const;

  std::uint32_t add_place(const tetfmt::Location& place);
  /// `peer`: the same ray for those that take points.
  void add(std::uint32_t place, const PeerRay& peer);
  void add_segment(std::uint32_t from_place, std::uint32_t to_place, const PeerRay& peer);
  PeerRay peer(std::size_t i) const {
    const Packet& p = packets[i / Packet::kSize];
    const std::size_t k = i % Packet::kSize;
    return {{p.origin_x[k], p.origin_y[k], p.origin_z[k]},
            {p.direction_x[k], p.direction_y[k], p.direction_z[k]},
            p.t_min[k],
            p.t_max[k]};
  }

  /// The rays of these numbers, in this order.
  RayList picked(const std::vector<std::uint32_t>& numbers) const;
};

}  // namespace tetbench
