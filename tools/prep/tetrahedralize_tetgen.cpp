// SPDX-License-Identifier: AGPL-3.0-or-later
// TetGen's answer is taken only when it proves to be one: every triangle is a face as it was, no surface
// point has moved, the hull is the box, and every tet has a volume in exact arithmetic.
#include <algorithm>
#include <cmath>
#include <optional>

#include "common/parse.hpp"
#include "prep/box.hpp"
#include "prep/intersections.hpp"
#include "prep/prep.hpp"
#include "prep/steiner.hpp"
#include "prep/tetgen_child.hpp"

namespace tetprep {
namespace {

/// TetGen's tets are all of this orientation.
constexpr int kTetgenSign = 1;

/// Switches, the most desirable first. -Y keeps the surface as it is. -q here means tetgen_refine.hpp.
std::vector<std::string> attempts(double radius_edge) {
  std::vector<std::string> list;
  const std::string quality = "q" + number(radius_edge);
  if (radius_edge > 0) list.push_back("pYQ" + quality);
  list.push_back("pYQ");
  // The tolerance decides when TetGen takes four points to be in one plane. Nothing here is only nearly so.
  list.push_back("pYQT1e-14");
  if (radius_edge > 0) list.push_back("pYQT1e-14" + quality);
  return list;
}

/// 356,000 triangles take about 6 s, and time grows a little faster than their number.
double default_time_limit(std::size_t triangles) {
  return 60 + 5e-4 * static_cast<double>(triangles);
}

[[noreturn]] void throw_intersecting(const CleanSurface& surface, std::vector<TrianglePair> pairs,
                                     TetrahedralizeReport& report) {
  constexpr std::size_t kListed = 10'000;
  report.intersection_count = pairs.size();
  report.intersections.clear();
  for (std::size_t i = 0; i < std::min(kListed, pairs.size()); ++i)
    report.intersections.push_back(
        {surface.input_triangle[pairs[i].first], surface.input_triangle[pairs[i].second]});
  throw Intersecting{std::move(pairs)};
}

/// The surface inside its box, as TetGen gets it: facets are the surface's triangles, then the box's.
struct Domain {
  std::vector<GridPoint> points;
  std::vector<std::array<Index, 3>> facets;
  std::size_t surface_points, surface_triangles;

  explicit Domain(const CleanSurface& surface)
      : points(surface.points),
        facets(surface.triangles),
        surface_points(surface.points.size()),
        surface_triangles(surface.triangles.size()) {
    const auto corners = box_around(points).corners();
    points.insert(points.end(), corners.begin(), corners.end());
    for (auto triangle : Box::kTriangles) {
      for (Index& corner : triangle) corner += static_cast<Index>(surface_points);
      facets.push_back(triangle);
    }
  }
};

/// Renumbers Steiner points so that those without a tet disappear. `points` and `tets` as in TetMesh.
std::vector<Point> used_steiner_points(std::span<const Point> points, std::size_t first_free,
                                       std::vector<std::array<Index, 4>>& tets) {
  std::vector<Index> number(points.size() - first_free, kNone);
  for (const auto& tet : tets)
    for (const Index v : tet)
      if (v >= first_free) number[v - first_free] = 0;
  std::vector<Point> used;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] == kNone) continue;
    number[i] = static_cast<Index>(first_free + used.size());
    used.push_back(points[first_free + i]);
  }
  if (used.size() < number.size())
    for (auto& tet : tets)
      for (Index& v : tet)
        if (v >= first_free) v = number[v - first_free];
  return used;
}

/// What is wrong with the faces, or an empty string.
std::string check_faces(const TetMesh& mesh, const Domain& domain) {
  std::vector<std::uint8_t> sides(domain.surface_triangles, 0);
  std::size_t hull = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    for (std::size_t k = 0; k < 4; ++k) {
      const Index facet = mesh.face_triangle[t][k];
      std::array<Index, 3> face{};
      for (std::size_t i = 0, j = 0; i < 4; ++i)
        if (i != k) face[j++] = mesh.tets[t][i];
      if (mesh.neighbors[t][k] == kNone) {
        ++hull;
        for (const Index v : face)
          if (v < domain.surface_points || v >= domain.points.size()) return "the box did not stay the hull";
      }
      if (facet == kNone) continue;
      auto expected = domain.facets[facet];
      std::sort(face.begin(), face.end());
      std::sort(expected.begin(), expected.end());
      if (face != expected) return "a triangle was changed";
      ++sides[facet];
    }
  }
  if (hull != Box::kTriangles.size()) return "the box did not stay the hull";
  if (std::any_of(sides.begin(), sides.end(), [](int n) { return n != 2; })) return "a triangle was lost";
  return {};
}

/// Turns TetGen's arrays into a TetMesh, or says why they are none.
std::string accept(const TetgenMesh& raw, const Domain& domain, TetMesh& mesh, TetrahedralizeReport& report) {
  const std::size_t fixed = domain.points.size();
  for (std::size_t i = 0; i < fixed; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      if (raw.points[i][k] != domain.points[i][k]) return "a point of the surface was moved";
  mesh.tets.assign(raw.tets.begin(), raw.tets.end());
  mesh.neighbors.assign(raw.neighbors.begin(), raw.neighbors.end());
  mesh.face_triangle.assign(raw.facets.begin(), raw.facets.end());
  for (auto& row : mesh.face_triangle)
    for (Index& facet : row)
      if (facet != kNone && facet >= domain.surface_triangles) facet = kNone;  // the box's faces are the hull
  if (std::string problem = check_faces(mesh, domain); !problem.empty()) return problem;

  mesh.points = domain.points;
  const std::vector<Point> steiner = used_steiner_points(raw.points, fixed, mesh.tets);
  const auto moved = place_steiner_points(mesh.points, fixed, steiner, mesh.tets, kTetgenSign);
  if (!moved) return "some tetrahedra are too flat for the grid";
  report.steiner_points = static_cast<Index>(steiner.size());
  report.moved_steiner_points = *moved;
  return {};
}

}  // namespace

TetMesh tetrahedralize(const CleanSurface& surface, const TetrahedralizeOptions& options, Progress& progress,
                       StageLog& log, TetrahedralizeReport& report) {
  const Domain domain(surface);
  const double limit =
      options.time_limit > 0 ? options.time_limit : default_time_limit(surface.triangles.size());
  std::optional<IntersectionSearch> search;
  for (const std::string& switches : attempts(options.radius_edge)) {
    log.begin("tetrahedralize");
    TetgenChild child(domain.points, domain.facets, switches);
    // Beside TetGen, so it takes no time of its own; after the fork, which wants no threads around.
    if (!search) search.emplace(surface, options.threads);
    auto outcome = child.wait(limit, progress, [&] { return search->found_any(); });
    if (outcome.mesh) {
      log.begin("verify");
      TetMesh mesh;
      mesh.origin = surface.origin;
      mesh.grid_exponent = surface.grid_exponent;
      outcome.reason = accept(*outcome.mesh, domain, mesh, report);
      if (outcome.reason.empty()) {
        log.end();
        // All triangles are faces of one mesh, so none intersects another: no need to wait for the search.
        for (StageCost& cost : outcome.stages) {
          report.tetgen_seconds += cost.seconds;
          log.add(std::move(cost));
        }
        report.switches = switches;
        return mesh;
      }
    }
    log.end();
    if (const auto& pairs = search->wait(); !pairs.empty()) throw_intersecting(surface, pairs, report);
    report.failed_attempts.push_back({switches, outcome.reason});
  }
  std::string text = "TetGen found no tetrahedra for this surface, which does not intersect itself;";
  for (const auto& [switches, reason] : report.failed_attempts) text += " -" + switches + ": " + reason + ";";
  text.back() = '.';
  throw Failure(ExitCode::runtime, text);
}

}  // namespace tetprep
