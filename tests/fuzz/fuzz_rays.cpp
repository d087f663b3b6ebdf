// SPDX-License-Identifier: AGPL-3.0-or-later
// Any rays through valid files: the fuzzer's bytes choose one of a few small meshes, then places, directions
// and intervals of any bits. Whatever they are, both layouts, checked and trusted, and every exact variant of
// the walk, alone, in a tile or in a batch, give one answer; nothing is corrupt; no ray that leaves a face
// meets it; intervals that share an end share no hit and lose none; closed surfaces are crossed in pairs.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "format/format_support.hpp"
#include "fuzz/fuzz_support.hpp"
#include "support/same.hpp"
#include "support/shear.hpp"
#include "tetfmt/batch.hpp"
#include "tetfmt/encode.hpp"
#include "tetfmt/kernels.hpp"
#include "tetfmt/traverse.hpp"
#include "tetfmt/validate.hpp"

namespace {

using namespace tetfmt;
using namespace tetfmt_test;

struct File {
  File(const Mesh& mesh, Layout layout)
      : bytes(encode(mesh, layout)), trusted(*TrustedView::validated(bytes)) {}
  const FileView& view() const { return trusted.view(); }
  std::vector<std::byte> bytes;
  TrustedView trusted;
};

struct Pair {
  explicit Pair(const Mesh& mesh) : tet20(mesh, Layout::tet20), tet16(mesh, Layout::tet16) {}
  /// What all four views answer.
  template <class Ask>
  auto by_all(Ask&& ask) const {
    const auto answer = ask(tet20.trusted);
    require(same(answer, ask(tet16.trusted)));
    require(same(answer, ask(tet20.view())));
    require(same(answer, ask(tet16.view())));
    return answer;
  }
  File tet20, tet16;
};

const Pair& some_mesh(std::size_t number) {
  static const auto meshes = [] {
    LatticeOptions open;
    open.walls = 5;
    std::vector<std::unique_ptr<const Pair>> made;
    for (const Mesh& mesh :
         {lattice_mesh(4), sheared(lattice_mesh(4)), with_regions(lattice_mesh(3), {0, 1}),
          with_regions(sheared(lattice_mesh(3)), {0}), with_regions(lattice_mesh(4), {1}),
          sheared(lattice_mesh(4, open)), full_mesh(3), attributed_mesh(), room(), one_tet(), two_tets()})
      made.push_back(std::make_unique<const Pair>(mesh));
    return made;
  }();
  return *meshes[number % meshes.size()];
}

bool finite(const Vec3f& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// 1: the direction goes off the face that `from` is on; -1: into it; 0: too close to tell.
int leaves(const FileView& view, const Location& from, const Vec3f& direction) {
  std::array<std::array<double, 3>, 4> p{};
  for (std::size_t k = 0, n = 0; k < 4; ++k) {
    const Vec3f& v = view.vertices()[from.cell.vertices[k]];
    p[k == from.face ? 3 : n++] = {v.x, v.y, v.z};
  }
  const double d[3] = {direction.x, direction.y, direction.z};
  double along = 0, towards_apex = 0, size = 0;
  for (std::size_t k = 0; k < 3; ++k) {  // small multiples of the grid: the normal is exact
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    const double n = (p[1][i] - p[0][i]) * (p[2][j] - p[0][j]) - (p[1][j] - p[0][j]) * (p[2][i] - p[0][i]);
    along += n * d[k];
    size += std::abs(n * d[k]);
    towards_apex += n * (p[3][k] - p[0][k]);
  }
  if (std::abs(along) <= 1e-15 * size) return 0;
  return (along > 0) == (towards_apex > 0) ? 1 : -1;
}

/// A list of hits with how it ended.
struct Crossings {
  Outcome outcome{};
  std::vector<Hit> hits;
  friend bool same(const Crossings& a, const Crossings& b) {
    return a.outcome == b.outcome && tetfmt_test::same(a.hits, b.hits);
  }
};
Crossings crossings(const Pair& mesh, const Location& from, const Vec3f& direction,
                    const Interval& interval) {
  return mesh.by_all([&](const auto& view) {
    Crossings all;
    all.outcome = all_hits(view, from, direction, all.hits, interval);
    return all;
  });
}

/// One ray by every operation. Returns its first hit.
Hit follow(const Pair& mesh, const Location& from, const Vec3f& direction, const Interval& interval) {
  const FileView& file = mesh.tet20.view();
  const Hit hit = mesh.by_all([&](const auto& view) { return first_hit(view, from, direction); });
  require(hit.outcome != Outcome::corrupt && hit.steps <= file.tet_count() + 1);
  for (const Basis basis : {Basis::shear, Basis::orthonormal, Basis::specialised})
    for (const Arithmetic arithmetic : {Arithmetic::exact, Arithmetic::float_first})
      for (const File* layout : {&mesh.tet20, &mesh.tet16})
        require(same(hit, first_hit(layout->trusted, from, direction, Variant{arithmetic, basis})));
  const Hit rough = first_hit(file, from, direction, {}, Kernel::float_only);
  require(rough.steps <= file.tet_count() + 1);

  const Hit bounded =
      mesh.by_all([&](const auto& view) { return first_hit(view, from, direction, interval); });
  require(bounded.outcome ==
          mesh.by_all([&](const auto& view) { return occlusion(view, from, direction, interval); }));
  require(bounded.steps <= std::max(hit.steps, file.tet_count()) + 1);
  if (bounded.outcome == Outcome::hit)
    require(bounded.t >= interval.t_min && bounded.t >= 0 && bounded.t <= interval.t_max);

  const Crossings all = crossings(mesh, from, direction, {});
  require(all.outcome != Outcome::corrupt && all.hits.size() <= file.tet_count() + 1);
  require(all.hits.empty() ? hit.outcome != Outcome::hit : same(all.hits[0], hit));
  for (std::size_t i = 0; i < all.hits.size(); ++i) {
    const Hit& here = all.hits[i];
    require(here.t >= 0 && here.u >= 0 && here.v >= 0 && here.side_u + here.side_v <= 1);
    require(file.sides()[here.side].tet == here.tet && file.sides()[twin(here.side)].tet == here.neighbor);
    if (i > 0) {
      require(all.hits[i - 1].t <= here.t && all.hits[i - 1].steps < here.steps);
      require(file.region_of(all.hits[i - 1].neighbor) == file.region_of(here.tet));
    }
  }

  // What lies in [0, t_min], in [t_min, t_max] and beyond is everything.
  const double infinity = std::numeric_limits<double>::infinity();
  if (interval.t_min >= 0 && interval.t_max >= interval.t_min && interval.t_max < infinity &&
      all.outcome != Outcome::absent) {
    std::vector<Index> together;
    for (const Interval& part : {Interval{0, interval.t_min}, interval, Interval{interval.t_max, infinity}}) {
      const Crossings some = crossings(mesh, from, direction, part);
      require(some.outcome == Outcome::miss);
      for (const Hit& one : some.hits) together.push_back(one.side);
    }
    require(together.size() == all.hits.size());
    for (std::size_t i = 0; i < together.size(); ++i) require(together[i] == all.hits[i].side);
  }
  return hit;
}

void check(std::span<const std::byte> bytes) {
  Reader reader(bytes);
  const auto number = reader.take<std::uint8_t>();
  const Pair& mesh = some_mesh(number);
  const FileView& file = mesh.tet20.view();
  const bool closed = number % 11 < 3;  // and nothing left out
  const Vec3f origin = reader.take_vector();
  Location from = mesh.by_all([&](const auto& view) { return locate(view, origin); });
  require(from.state != Location::State::corrupt);
  const Location start = from;

  for (int bounce = 0; bounce < 8; ++bounce) {
    const Vec3f direction = reader.take_vector();
    const double t_min = reader.take_end(), t_max = reader.take_end();
    const Hit hit = follow(mesh, from, direction, {t_min, t_max});
    if (!finite(origin) || !finite(direction) || direction == Vec3f{})
      require(hit.outcome == Outcome::miss || hit.outcome == Outcome::absent);
    if (from.state == Location::State::outside && closed)
      require(crossings(mesh, from, direction, {}).hits.size() % 2 == 0);
    if (from.face != Location::kNoFace && finite(direction)) {
      const Ref own = from.cell.neighbors[from.face];
      const int leaving = leaves(file, from, direction);
      const bool met = hit.outcome == Outcome::hit && side_ref(hit.side) == own;
      if (leaving > 0) require(!met);
      if (leaving < 0) require(met && hit.t == 0);
    }
    const std::vector<Vec3f> directions = fan(direction, reader);
    const std::vector<Hit> together = mesh.by_all([&](const auto& view) {
      std::vector<Hit> hits(directions.size());
      first_hits(view, from, directions, hits);
      return hits;
    });
    for (std::size_t i = 0; i < directions.size(); ++i)
      require(same_but_for_steps(together[i], first_hit(mesh.tet16.trusted, from, directions[i])));
    // In a batch, from both places, with and without ends.
    const std::vector<Location> places = {start, from};
    std::vector<BatchRay> rays;
    for (std::uint32_t i = 0; i < directions.size(); ++i)
      rays.push_back({i / 2 % 2, directions[i], i % 2 == 0 ? Interval{} : Interval{t_min, t_max}});
    const std::vector<Hit> in_batch = mesh.by_all([&](const auto& view) {
      std::vector<Hit> hits(rays.size());
      trace_batch(view, places, rays, hits);
      return hits;
    });
    std::vector<Outcome> blocked(rays.size());
    occlude_batch(mesh.tet20.trusted, places, rays, blocked);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Location& place = places[rays[i].from];
      const Hit one = first_hit(mesh.tet16.trusted, place, rays[i].direction, rays[i].interval);
      require(same_but_for_steps(in_batch[i], one) && blocked[i] == one.outcome);
    }
    // Any place sees itself, and whoever sees is seen.
    const auto sees = [&](const Location& a, const Location& b) {
      return mesh.by_all([&](const auto& view) { return occlusion(view, a, b); });
    };
    const Outcome there = sees(start, from), back = sees(from, start);
    require(there != Outcome::corrupt && back != Outcome::corrupt);
    using enum Location::State;
    if (start.state != absent && from.state != absent) require(there == back);
    std::array<Outcome, 2> segments{};
    occlude_batch(mesh.tet16.trusted, places, std::array{BatchSegment{0, 1}, BatchSegment{1, 0}}, segments);
    require(segments[0] == there && segments[1] == back);
    if (start.state != absent && finite(origin)) require(sees(start, start) == Outcome::miss);
    // From one place to many: as many as are walked together.
    std::vector<Location> targets;
    for (const Hit& met : together) {
      if (met.outcome != Outcome::hit) continue;
      targets.push_back(near_side(file, met));
      targets.push_back(far_side(file, met));
    }
    const std::vector<Outcome> seen = mesh.by_all([&](const auto& view) {
      std::vector<Outcome> outcomes(targets.size());
      occlusions(view, start, targets, outcomes);
      return outcomes;
    });
    for (std::size_t i = 0; i < targets.size(); ++i)
      require(seen[i] == occlusion(mesh.tet16.trusted, start, targets[i]));

    if (hit.outcome != Outcome::hit) break;
    const bool far = reader.take<std::uint8_t>() % 2 == 1;
    from = far ? far_side(file, hit) : near_side(file, hit);
    require(same(from, far ? far_side(mesh.tet16.view(), hit) : near_side(mesh.tet16.view(), hit)));
    require(from.state == ((far ? hit.neighbor : hit.tet) == kNone ? absent : inside));
    if (from.state == absent) break;
    require(from.cell.tet == (far ? hit.neighbor : hit.tet));
    require(from.cell.neighbors[from.face] == side_ref(far ? twin(hit.side) : hit.side));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check(std::as_bytes(std::span(data, size)));
  return 0;
}
