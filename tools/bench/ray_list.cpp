// SPDX-License-Identifier: AGPL-3.0-or-later
#include "bench/ray_list.hpp"

#include <algorithm>

namespace tetbench {
namespace {

/// Empty intervals are not traced, whatever the rest says.
constexpr Packet unused() {
  Packet packet;
  packet.direction_z.fill(1);
  packet.t_min.fill(1);
  packet.t_max.fill(0);
  return packet;
}

void put(Packet& p, std::size_t k, const PeerRay& ray) {
  p.origin_x[k] = ray.origin.x, p.origin_y[k] = ray.origin.y, p.origin_z[k] = ray.origin.z;
  p.direction_x[k] = ray.direction.x, p.direction_y[k] = ray.direction.y, p.direction_z[k] = ray.direction.z;
  p.t_min[k] = ray.t_min, p.t_max[k] = ray.t_max;
}

}  // namespace

bool RayList::unbounded() const {
  return to.empty() && std::all_of(t_max.begin(), t_max.end(),
                                   [](float t) { return t == std::numeric_limits<float>::infinity(); });
}

std::uint32_t RayList::add_place(const tetfmt::Location& place) {
  places.push_back(place);
  return static_cast<std::uint32_t>(places.size() - 1);
}

void RayList::add(std::uint32_t place, const PeerRay& peer) {
  const std::size_t lane = directions.size() % Packet::kSize;
  if (lane == 0) packets.push_back(unused());
  put(packets.back(), lane, peer);
  from.push_back(place);
  directions.push_back(peer.direction);
  t_max.push_back(peer.t_max);
}

void RayList::add_segment(std::uint32_t from_place, std::uint32_t to_place, const PeerRay& peer) {
  add(from_place, peer);
  to.push_back(to_place);
}

RayList RayList::picked(const std::vector<std::uint32_t>& numbers) const {
  RayList result;
  result.occlusion = occlusion;
  result.coherent = coherent;
  result.distance = distance;
  result.places = places;
  for (const std::uint32_t i : numbers) {
    result.add(from[i], peer(i));
    if (!to.empty()) result.to.push_back(to[i]);
  }
  return result;
}

}  // namespace tetbench
