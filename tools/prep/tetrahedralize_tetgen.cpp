// SPDX-License-Identifier: AGPL-3.0-or-later
// TetGen's answer is taken only when it proves to be one: every triangle is a face as it was, no surface
// point has moved, the hull is the box, and every tet has a volume in exact arithmetic. Where TetGen had to
// put points on triangles, each of these is made up of faces instead, and the surface is cut accordingly.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/parse.hpp"
#include "prep/box.hpp"
#include "prep/cut_surface.hpp"
#include "prep/describe.hpp"
#include "prep/intersections.hpp"
#include "prep/prep.hpp"
#include "prep/steiner.hpp"
#include "prep/tetgen_child.hpp"

namespace tetprep {
namespace {

/// TetGen's tets are all of this orientation.
constexpr int kTetgenSign = 1;

constexpr const char* kNoRoom = "some tetrahedra are too flat for the grid";

/// Switches, the most desirable first. -Y keeps the surface as it is. -q here means tetgen_refine.hpp.
struct Attempt {
  std::string switches;
  bool may_cut;
  std::string name() const { return switches + (may_cut ? ", cutting triangles" : ""); }
  bool refines() const { return switches.find('q') != std::string::npos; }
  bool exact_planes() const { return switches.find('T') != std::string::npos; }
};

std::vector<Attempt> attempts(double radius_edge) {
  std::vector<Attempt> list;
  // The tolerance decides when TetGen takes four points to be in one plane. Nothing here is only nearly so.
  for (const bool may_cut : {false, true}) {
    for (const std::string plain : {"pYQ", "pYQT1e-14"}) {
      if (radius_edge > 0) list.push_back({plain + "q" + number(radius_edge), may_cut});
      list.push_back({plain, may_cut});
    }
  }
  return list;
}

/// Whether `next` would end as `failed` did, in `stage`: it differs from it only in what comes later.
bool is_pointless(const Attempt& next, const Attempt& failed, const std::string& stage) {
  const bool late = stage == "refinement" || stage == "optimization" || stage == "hand over";
  return !late && next.may_cut == failed.may_cut && next.exact_planes() == failed.exact_planes();
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

/// What is wrong with the hull, or an empty string. Sets `cut` if some triangle is not a face as it was.
std::string check_faces(const TetMesh& mesh, const Domain& domain, bool& cut) {
  std::vector<std::uint8_t> sides(domain.surface_triangles, 0);
  std::size_t hull = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    for (std::size_t k = 0; k < 4; ++k) {
      const Index facet = mesh.face_triangle[t][k];
      const bool at_hull = mesh.neighbors[t][k] == kNone;
      if (facet == kNone && !at_hull) continue;
      std::array<Index, 3> face{};
      for (std::size_t i = 0, j = 0; i < 4; ++i)
        if (i != k) face[j++] = mesh.tets[t][i];
      if (at_hull) {
        ++hull;
        for (const Index v : face)
          if (v < domain.surface_points || v >= domain.points.size()) return "the box did not stay the hull";
      }
      if (facet == kNone) continue;
      auto expected = domain.facets[facet];
      std::sort(face.begin(), face.end());
      std::sort(expected.begin(), expected.end());
      cut |= face != expected;
      ++sides[facet];
    }
  }
  if (hull != Box::kTriangles.size()) return "the box did not stay the hull";
  cut |= std::any_of(sides.begin(), sides.end(), [](int n) { return n != 2; });
  return {};
}

/// What accept() works on. The surface may have to change, and is in use elsewhere until that is sure.
struct Candidate {
  TetMesh mesh;
  CleanSurface surface;  ///< empty if it stays as it is
  bool changed = false;
  Index steiner_points = 0, moved_steiner_points = 0, cut_triangles = 0;
  int grid_refinement = 0;
  double cut_deviation = 0;
};

/// Everything that has coordinates.
struct Places {
  Point origin{};
  int grid_exponent = 0;
  std::vector<GridPoint> fixed;  ///< the surface's and the box's
  std::vector<Point> steiner;
};

/// Makes the grid twice as fine, around the middle of the box if coordinates get too large otherwise. False
/// if they do anyway, if float32 has no such step, or if no origin is exact.
bool refine_grid(Places& places) {
  const GridPoint &low = places.fixed[places.fixed.size() - 8], &high = places.fixed.back();
  GridPoint middle{};
  constexpr std::int32_t kMost = kMaxCoordinate / 2;
  for (std::size_t k = 0; k < 3; ++k)
    if (std::max(std::abs(low[k]), std::abs(high[k])) > kMost) middle = Box{low, high}.centre();
  const double step = std::ldexp(1.0, places.grid_exponent);
  Point origin{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (std::max(std::abs(low[k] - middle[k]), std::abs(high[k] - middle[k])) > kMost) return false;
    const double shift = middle[k] * step;
    origin[k] = places.origin[k] + shift;
    if (origin[k] - places.origin[k] != shift || origin[k] - shift != places.origin[k]) return false;
  }
  if (places.grid_exponent < std::numeric_limits<float>::min_exponent) return false;
  places.origin = origin;
  --places.grid_exponent;
  const auto refine = [&](auto& points) {
    for (auto& p : points)
      for (std::size_t k = 0; k < 3; ++k) p[k] = 2 * (p[k] - middle[k]);
  };
  refine(places.fixed);
  refine(places.steiner);
  return true;
}

/// Places the Steiner points, on a finer grid where they need one; the first `bound` of them are on
/// triangles. False if that cannot be done.
bool place(Places& places, std::size_t bound, Candidate& candidate) {
  TetMesh& mesh = candidate.mesh;
  constexpr int kMostRefinements = 3;
  for (int refinement = 0;; ++refinement) {
    mesh.points = places.fixed;
    const int reach = std::min(1 << refinement, 4);  // about one step of the grid that the surface came on
    if (const auto moved = place_steiner_points(mesh.points, places.fixed.size(), places.steiner, mesh.tets,
                                                kTetgenSign, bound, reach)) {
      candidate.moved_steiner_points = *moved;
      candidate.grid_refinement = refinement;
      return true;
    }
    // Tets between points that cannot move do not get better on any grid.
    if (places.steiner.empty() || refinement == kMostRefinements || !refine_grid(places)) return false;
  }
}

/// Renumbers Steiner points so that those on triangles come first. Returns how many these are.
std::size_t put_bound_first(std::vector<Point>& steiner, std::size_t fixed, std::vector<Piece>& pieces,
                            std::vector<std::array<Index, 4>>& tets) {
  std::vector<bool> bound(steiner.size(), false);
  for (const Piece& piece : pieces)
    for (const Index v : piece.corners)
      if (v >= fixed) bound[v - fixed] = true;
  std::vector<Index> number(steiner.size());
  std::vector<Point> sorted;
  std::size_t count = 0;
  for (const bool wanted : {true, false}) {
    for (std::size_t i = 0; i < steiner.size(); ++i) {
      if (bound[i] != wanted) continue;
      number[i] = static_cast<Index>(fixed + sorted.size());
      sorted.push_back(steiner[i]);
    }
    if (wanted) count = sorted.size();
  }
  const auto renumber = [&](auto& corners) {
    for (Index& v : corners)
      if (v >= fixed) v = number[v - fixed];
  };
  for (auto& tet : tets) renumber(tet);
  for (Piece& piece : pieces) {
    renumber(piece.corners);
    std::sort(piece.corners.begin(), piece.corners.end());
  }
  std::sort(pieces.begin(), pieces.end());
  steiner = std::move(sorted);
  return count;
}

/// Makes the first `bound` Steiner points the surface's, and its triangles the pieces that they cut them
/// into.
void cut_surface(const Places& places, std::size_t bound, std::vector<Piece> pieces, Candidate& candidate) {
  TetMesh& mesh = candidate.mesh;
  CleanSurface& surface = candidate.surface;
  const std::size_t box = surface.points.size(), steiner = box + 8;
  const auto shift = [&](Index& v) {
    if (v >= steiner + bound || v < box) return;
    v = static_cast<Index>(v < steiner ? v + bound : v - 8);
  };
  for (auto& tet : mesh.tets)
    for (Index& v : tet) shift(v);
  for (Piece& piece : pieces)
    for (Index& v : piece.corners) shift(v);
  const auto first = mesh.points.begin() + static_cast<std::ptrdiff_t>(box);
  std::rotate(first, first + 8, first + 8 + static_cast<std::ptrdiff_t>(bound));

  const std::vector<Index> number = find_pieces(mesh.tets, mesh.face_triangle, pieces);
  for (std::size_t t = 0, i = 0; t < mesh.tets.size(); ++t)
    for (Index& triangle : mesh.face_triangle[t])
      if (triangle != kNone) triangle = number[i++];

  std::vector<Point> exact;
  for (const GridPoint& p : surface.points) exact.push_back({double(p[0]), double(p[1]), double(p[2])});
  for (std::size_t i = 0; i < bound; ++i) {
    const GridPoint& p = mesh.points[box + i];
    const Point& wanted = places.steiner[i];
    exact.push_back(wanted);
    surface.points.push_back(p);
    candidate.cut_deviation = std::max(
        candidate.cut_deviation,
        std::ldexp(std::hypot(p[0] - wanted[0], p[1] - wanted[1], p[2] - wanted[2]), places.grid_exponent));
  }
  candidate.cut_triangles = replace_by_pieces(surface, pieces, exact);
}

/// Turns TetGen's arrays into a TetMesh, or says why they are none.
std::string accept(const TetgenMesh& raw, const CleanSurface& surface, const Domain& domain,
                   Candidate& candidate) {
  const std::size_t fixed = domain.points.size();
  for (std::size_t i = 0; i < fixed; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      if (raw.points[i][k] != domain.points[i][k]) return "a point of the surface was moved";
  TetMesh& mesh = candidate.mesh;
  mesh.tets.assign(raw.tets.begin(), raw.tets.end());
  mesh.neighbors.assign(raw.neighbors.begin(), raw.neighbors.end());
  mesh.face_triangle.assign(raw.facets.begin(), raw.facets.end());
  for (auto& row : mesh.face_triangle)
    for (Index& facet : row)
      if (facet != kNone && facet >= domain.surface_triangles) facet = kNone;  // the box's faces are the hull
  bool cut = false;
  if (std::string problem = check_faces(mesh, domain, cut); !problem.empty()) return problem;

  Places places{surface.origin, surface.grid_exponent, domain.points,
                used_steiner_points(raw.points, fixed, mesh.tets)};
  std::vector<Piece> pieces;
  std::size_t bound = 0;
  if (cut) {
    pieces = collect_pieces(mesh.tets, mesh.face_triangle);
    bound = put_bound_first(places.steiner, fixed, pieces, mesh.tets);
    std::vector<Point> wanted(raw.points.begin(), raw.points.begin() + static_cast<std::ptrdiff_t>(fixed));
    wanted.insert(wanted.end(), places.steiner.begin(), places.steiner.end());
    if (std::string problem = check_pieces(surface, pieces, wanted); !problem.empty()) return problem;
  }
  if (!place(places, bound, candidate)) return kNoRoom;
  candidate.steiner_points = static_cast<Index>(places.steiner.size());
  mesh.origin = places.origin;
  mesh.grid_exponent = places.grid_exponent;
  if (cut || candidate.grid_refinement > 0) {
    candidate.changed = true;
    candidate.surface = surface;
    candidate.surface.origin = places.origin;
    candidate.surface.grid_exponent = places.grid_exponent;
    std::copy_n(places.fixed.begin(), surface.points.size(), candidate.surface.points.begin());
    if (cut) cut_surface(places, bound, std::move(pieces), candidate);
  }
  return {};
}

/// "; it was busy with triangles 5 (0 1 2), 7 (0 3 4)": the first few of them.
std::string describe_suspects(const CleanSurface& surface, const std::vector<Index>& suspects) {
  constexpr std::size_t kNamed = 4;
  std::string text = suspects.empty() ? "" : "; last in its way (numbers from 0, each with a corner): ";
  for (std::size_t i = 0; i < std::min(kNamed, suspects.size()); ++i)
    text += (i == 0 ? "triangle " : ", ") + describe_triangle(surface, suspects[i]);
  return text;
}

}  // namespace

TetMesh tetrahedralize(CleanSurface& surface, const TetrahedralizeOptions& options, Progress& progress,
                       StageLog& log, TetrahedralizeReport& report) {
  const Domain domain(surface);
  const double limit =
      options.time_limit > 0 ? options.time_limit : default_time_limit(surface.triangles.size());
  std::optional<IntersectionSearch> search;
  const Attempt* failed = nullptr;
  std::string failed_stage;
  const auto list = attempts(options.radius_edge);
  for (const Attempt& attempt : list) {
    if (failed != nullptr && is_pointless(attempt, *failed, failed_stage)) continue;
    log.begin("tetrahedralize");
    TetgenChild child(domain.points, domain.facets,
                      {attempt.switches, attempt.may_cut, options.memory_limit});
    // Beside TetGen, so it takes no time of its own; after the fork, which wants no threads around.
    if (!search) search.emplace(surface, options.threads);
    auto outcome = child.wait(limit, progress, [&] { return search->found_any(); });
    if (outcome.mesh) {
      log.begin("verify");
      Candidate candidate;
      outcome.reason = accept(*outcome.mesh, surface, domain, candidate);
      // What is wrong with the surface was so before any refinement.
      if (!outcome.reason.empty() && outcome.reason != kNoRoom) outcome.stage = "boundary recovery";
      if (outcome.reason.empty()) {
        log.end();
        // All triangles are made up of faces of one mesh, so none intersects another: no need to wait for the
        // search.
        search.reset();
        if (candidate.changed) surface = std::move(candidate.surface);
        for (StageCost& cost : outcome.stages) {
          report.tetgen_seconds += cost.seconds;
          log.add(std::move(cost));
        }
        report.switches = attempt.switches;
        report.steiner_points = candidate.steiner_points;
        report.moved_steiner_points = candidate.moved_steiner_points;
        report.cut_triangles = candidate.cut_triangles;
        report.cut_deviation = candidate.cut_deviation;
        report.grid_refinement = candidate.grid_refinement;
        report.suspects.clear();
        return std::move(candidate.mesh);
      }
    }
    log.end();
    if (const auto& pairs = search->wait(); !pairs.empty()) throw_intersecting(surface, pairs, report);
    report.failed_attempts.push_back({attempt.name(), outcome.reason});
    report.suspects.clear();
    for (const Index facet : outcome.stuck)
      if (facet < surface.triangles.size()) report.suspects.push_back(facet);
    failed = &attempt;
    failed_stage = outcome.stage;
  }
  std::string text = "TetGen found no tetrahedra for this surface, which does not intersect itself:";
  for (const auto& [switches, reason] : report.failed_attempts) text += " -" + switches + ": " + reason + ";";
  text.pop_back();
  text += describe_suspects(surface, report.suspects);
  if (std::any_of(report.failed_attempts.begin(), report.failed_attempts.end(),
                  [](const FailedAttempt& attempt) { return attempt.reason == kNoRoom; }))
    throw NoRoomOnGrid(ExitCode::runtime, text);
  throw Failure(ExitCode::runtime, text);
}

}  // namespace tetprep
