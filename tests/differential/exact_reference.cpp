// SPDX-License-Identifier: AGPL-3.0-or-later
#include "differential/exact_reference.hpp"

#include <CGAL/Interval_nt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

namespace tetfmt_test {

using tetfmt::Index;
using tetfmt::Ray;
using tetfmt::Vec3f;

namespace {

template <class N>
using Vector = std::array<N, 3>;

template <class N>
Vector<N> vector(const Vec3f& v) {
  return {N(static_cast<double>(v.x)), N(static_cast<double>(v.y)), N(static_cast<double>(v.z))};
}

template <class N>
Vector<N> from_to(const Vec3f& p, const Vec3f& q) {
  const auto a = vector<N>(p), b = vector<N>(q);
  return {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
}

template <class N>
Vector<N> cross(const Vector<N>& a, const Vector<N>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <class N>
N dot(const Vector<N>& a, const Vector<N>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The sign of `formula`, which is evaluated for a number type N given by a value of that type: in interval
/// arithmetic, and where the interval contains zero, exactly.
template <class Formula>
int exact_sign(const Formula& formula) {
  using Interval = CGAL::Interval_nt<false>;
  {
    const Interval::Protector rounding;
    const CGAL::Uncertain<CGAL::Sign> sign = CGAL::sign(formula(Interval(0)));
    if (CGAL::is_certain(sign)) return CGAL::get_certain(sign);
  }
  return CGAL::sign(formula(Exact(0)));
}

/// On which side of the line through p and q the ray passes: the sign of d . ((p - o) x (q - o)).
int side_of_edge(const Ray& ray, const Vec3f& p, const Vec3f& q) {
  return exact_sign([&](auto number) {
    using N = decltype(number);
    return dot(vector<N>(ray.direction), cross(from_to<N>(ray.origin, p), from_to<N>(ray.origin, q)));
  });
}

/// The sign of d . ((p - apex) x (q - apex)): whether q lies counter-clockwise of p around the apex, seen by
/// someone whom the ray flies towards.
int turn(const Ray& ray, const Vec3f& apex, const Vec3f& p, const Vec3f& q) {
  return exact_sign([&](auto number) {
    using N = decltype(number);
    return dot(vector<N>(ray.direction), cross(from_to<N>(apex, p), from_to<N>(apex, q)));
  });
}

struct Plane {
  Vector<Exact> normal;
  Exact along, height;  ///< normal . d and normal . (a - o): the line meets the plane at t = height / along
};

Plane plane(const Ray& ray, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vector<Exact> normal = cross(from_to<Exact>(a, b), from_to<Exact>(a, c));
  return {normal, dot(normal, vector<Exact>(ray.direction)), dot(normal, from_to<Exact>(ray.origin, a))};
}

double length(const Vec3f& a) {
  return std::hypot(double{a.x}, double{a.y}, double{a.z});
}

double distance(const Vec3f& a, const Vec3f& b) {
  return std::hypot(double{a.x} - double{b.x}, double{a.y} - double{b.y}, double{a.z} - double{b.z});
}

}  // namespace

ExactReference::ExactReference(std::span<const Vec3f> vertices, std::span<const tetfmt::Triangle> triangles)
    : vertices_(vertices), triangles_(triangles), tree_(vertices, triangles) {
  first_around_.assign(vertices.size() + 1, 0);
  for (const auto& triangle : triangles) {
    if (triangle.dropped()) continue;
    for (const Index v : triangle.vertices) ++first_around_[v + 1];
  }
  for (std::size_t i = 1; i < first_around_.size(); ++i) first_around_[i] += first_around_[i - 1];
  around_.resize(first_around_.back());
  std::vector<std::size_t> next(first_around_.begin(), first_around_.end() - 1);
  for (Index i = 0; i < triangles.size(); ++i) {
    if (triangles[i].dropped()) continue;
    for (const Index v : triangles[i].vertices) around_[next[v]++] = i;
  }
}

std::span<const Index> ExactReference::around(Index vertex) const {
  return std::span(around_).subspan(first_around_[vertex], first_around_[vertex + 1] - first_around_[vertex]);
}

std::optional<Barrier> ExactReference::barrier(const Ray& ray) const {
  std::optional<Barrier> nearest;
  tree_.visit(ray, std::numeric_limits<double>::infinity(), [&](Index triangle) {
    consider(triangle, ray, nearest);
    return nearest ? CGAL::to_interval(nearest->t).second : std::numeric_limits<double>::infinity();
  });
  return nearest;
}

std::optional<Barrier> ExactReference::barrier_without_tree(const Ray& ray) const {
  std::optional<Barrier> nearest;
  for (Index i = 0; i < triangles_.size(); ++i) {
    if (!triangles_[i].dropped()) consider(i, ray, nearest);
  }
  return nearest;
}

void ExactReference::consider(Index triangle, const Ray& ray, std::optional<Barrier>& nearest) const {
  const auto& ids = triangles_[triangle].vertices;
  std::array<int, 3> side{};
  for (std::size_t k = 0; k < 3; ++k) {
    side[k] = side_of_edge(ray, vertices_[ids[k]], vertices_[ids[(k + 1) % 3]]);
  }
  const auto [lowest, highest] = std::minmax_element(side.begin(), side.end());
  if (*lowest * *highest < 0 || (*lowest == 0 && *highest == 0)) return;  // beside it, or in its plane

  const Plane p = plane(ray, vertices_[ids[0]], vertices_[ids[1]], vertices_[ids[2]]);
  const Exact t = p.height / p.along;
  if (t <= 0 || (nearest && t >= nearest->t)) return;

  const auto zeros = std::count(side.begin(), side.end(), 0);
  if (zeros == 0) {
    nearest = {Barrier::Kind::interior, t};
  } else if (zeros == 1) {
    const auto k = static_cast<std::size_t>(std::find(side.begin(), side.end(), 0) - side.begin());
    if (edge_blocks(ids[k], ids[(k + 1) % 3], ray)) nearest = {Barrier::Kind::edge, t};
  } else {
    // The one edge that is not touched is opposite the vertex that is.
    const std::size_t k = side[0] != 0 ? 2 : side[1] != 0 ? 0 : 1;
    if (vertex_blocks(ids[k], ray)) nearest = {Barrier::Kind::vertex, t};
  }
}

/// A line through a point inside an edge is blocked if the edge has triangles on both sides of the line.
bool ExactReference::edge_blocks(Index from, Index to, const Ray& ray) const {
  bool left = false, right = false;
  for (const Index triangle : around(from)) {
    const auto& ids = triangles_[triangle].vertices;
    if (std::find(ids.begin(), ids.end(), to) == ids.end()) continue;
    for (const Index other : ids) {
      if (other == from || other == to) continue;
      const int side = turn(ray, vertices_[from], vertices_[to], vertices_[other]);
      left = left || side > 0;
      right = right || side < 0;
    }
  }
  return left && right;
}

/// A line through a vertex is blocked if the triangles around the vertex, seen along the line, cover a whole
/// turn: each sector ends where another begins (at the same neighbour vertex) or inside another.
bool ExactReference::vertex_blocks(Index vertex, const Ray& ray) const {
  struct Sector {
    Index begin, end;  ///< neighbour vertices, counter-clockwise
  };
  std::vector<Sector> sectors;
  for (const Index triangle : around(vertex)) {
    const auto& ids = triangles_[triangle].vertices;
    const auto k = static_cast<std::size_t>(std::find(ids.begin(), ids.end(), vertex) - ids.begin());
    const Index a = ids[(k + 1) % 3], b = ids[(k + 2) % 3];
    const int side = turn(ray, vertices_[vertex], vertices_[a], vertices_[b]);
    if (side != 0) sectors.push_back(side > 0 ? Sector{a, b} : Sector{b, a});
  }
  const auto goes_on_at = [&](Index end) {
    return std::any_of(sectors.begin(), sectors.end(), [&](const Sector& s) {
      return s.begin == end || (turn(ray, vertices_[vertex], vertices_[s.begin], vertices_[end]) > 0 &&
                                turn(ray, vertices_[vertex], vertices_[end], vertices_[s.end]) > 0);
    });
  };
  return !sectors.empty() &&
         std::all_of(sectors.begin(), sectors.end(), [&](const Sector& s) { return goes_on_at(s.end); });
}

std::optional<Contact> ExactReference::contact(Index triangle, const Ray& ray) const {
  const auto& ids = triangles_[triangle].vertices;
  const Vec3f &a = vertices_[ids[0]], &b = vertices_[ids[1]], &c = vertices_[ids[2]];
  const Plane p = plane(ray, a, b, c);
  const auto d = vector<Exact>(ray.direction);
  const auto oa = from_to<Exact>(ray.origin, a), ob = from_to<Exact>(ray.origin, b),
             oc = from_to<Exact>(ray.origin, c);
  if (p.along != 0) {
    Contact contact;
    contact.first = contact.last = p.height / p.along;
    contact.back = p.along > 0;
    contact.u = dot(d, cross(oc, oa)) / p.along;
    contact.v = dot(d, cross(oa, ob)) / p.along;
    if (contact.u < 0 || contact.v < 0 || contact.u + contact.v > 1) return std::nullopt;
    return contact;
  }
  if (p.height != 0) return std::nullopt;  // parallel, beside the plane

  // In the plane: cut the line by the three edges, each a linear inequality in t, seen along an axis that the
  // normal is not orthogonal to. Corners run counter-clockwise there if that component is positive.
  const std::size_t axis = p.normal[0] != 0 ? 0 : p.normal[1] != 0 ? 1 : 2;
  const auto flat = [&](const Vector<Exact>& x, const Vector<Exact>& y) {
    const Exact area = cross(x, y)[axis];
    return p.normal[axis] > 0 ? area : -area;
  };
  std::optional<Exact> first, last;
  const std::array<const Vector<Exact>*, 3> corners = {&oa, &ob, &oc};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto &from = *corners[k], &to = *corners[(k + 1) % 3];
    const Vector<Exact> edge = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    const Exact slope = flat(edge, d), offset = -flat(edge, from);  // inside: offset + slope * t >= 0
    if (slope == 0) {
      if (offset < 0) return std::nullopt;
      continue;
    }
    const Exact t = -offset / slope;
    if (slope > 0 && (!first || t > *first)) first = t;
    if (slope < 0 && (!last || t < *last)) last = t;
  }
  if (!first || !last || *first > *last) return std::nullopt;
  Contact contact;
  contact.first = *first;
  contact.last = *last;
  contact.in_plane = true;
  return contact;
}

std::string ExactReference::judge(const Ray& ray, const std::optional<Barrier>& barrier,
                                  const Answer& answer) const {
  constexpr double kTolerance = 1e-6;
  std::ostringstream problem;
  problem.precision(17);
  if (answer.triangle < 0) {
    if (barrier) problem << "a miss, but the surface is crossed at t = " << CGAL::to_double(barrier->t);
    return problem.str();
  }
  if (answer.triangle >= static_cast<std::int64_t>(triangles_.size()) ||
      triangles_[static_cast<std::size_t>(answer.triangle)].dropped()) {
    problem << "triangle " << answer.triangle << " does not exist";
    return problem.str();
  }
  const auto triangle = static_cast<Index>(answer.triangle);
  const auto found = contact(triangle, ray);
  problem << "triangle " << triangle;
  if (!found || found->last < 0) {
    problem << " is not met by the ray";
    return problem.str();
  }
  if (barrier && found->first > barrier->t) {
    problem << " at t = " << CGAL::to_double(found->first)
            << " lies behind the surface crossed at t = " << CGAL::to_double(barrier->t);
    return problem.str();
  }

  const auto& ids = triangles_[triangle].vertices;
  double reach = 0;
  for (const Index v : ids) reach = std::max(reach, distance(ray.origin, vertices_[v]));
  const double speed = length(ray.direction);
  if (found->in_plane) {
    const double low = std::max(0.0, CGAL::to_double(found->first));
    double high = CGAL::to_double(found->last);
    if (barrier) high = std::min(high, CGAL::to_double(barrier->t));
    const double slack = kTolerance * reach / speed;
    if (!(answer.t >= low - slack && answer.t <= high + slack)) {
      problem << ", in whose plane the ray lies, is met for t in [" << low << ", " << high << "], not at "
              << answer.t;
      return problem.str();
    }
    const auto point = [&](std::size_t k) {
      const auto a = vector<double>(vertices_[ids[0]]);
      const auto ab = from_to<double>(vertices_[ids[0]], vertices_[ids[1]]);
      const auto ac = from_to<double>(vertices_[ids[0]], vertices_[ids[2]]);
      const auto o = vector<double>(ray.origin), d = vector<double>(ray.direction);
      return std::abs(a[k] + answer.u * ab[k] + answer.v * ac[k] - o[k] - answer.t * d[k]);
    };
    if (!(std::max({point(0), point(1), point(2)}) <= kTolerance * reach)) {
      problem << ": u = " << answer.u << " and v = " << answer.v << " are not the point at t = " << answer.t;
      return problem.str();
    }
    return {};
  }

  // What the textbook formulas, evaluated in double, may lose: each is a sum of products over `along`.
  constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
  const Plane p = plane(ray, vertices_[ids[0]], vertices_[ids[1]], vertices_[ids[2]]);
  const double along = std::abs(CGAL::to_double(p.along));
  const double normal =
      std::hypot(CGAL::to_double(p.normal[0]), CGAL::to_double(p.normal[1]), CGAL::to_double(p.normal[2]));
  const double t = CGAL::to_double(found->first), u = CGAL::to_double(found->u),
               v = CGAL::to_double(found->v);
  const double t_slack = kTolerance * t + kRounding * normal * reach / along;
  const double uv_slack = kTolerance + kRounding * speed * reach * reach / along;
  if (!(std::abs(answer.t - t) <= t_slack)) {
    problem << " is met at t = " << t << ", not " << answer.t;
  } else if (!(std::abs(answer.u - u) <= uv_slack && std::abs(answer.v - v) <= uv_slack)) {
    problem << " is met at u, v = " << u << ", " << v << ", not " << answer.u << ", " << answer.v;
  } else if (answer.side != (found->back ? 1 : 0)) {
    problem << " is met from the other side";
  } else {
    return {};
  }
  return problem.str();
}

}  // namespace tetfmt_test
