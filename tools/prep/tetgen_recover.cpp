// SPDX-License-Identifier: AGPL-3.0-or-later
// TetGen's own recoverboundary() has three ways to fail that its parts do not have:
// - Its last resort before adding points are flips without any bound on how many may depend on each other.
//   That is exponential: 500 long triangles in a heap do not end. Here the bound stops growing.
// - It splits an edge where that comes nearest to another, after trials that trip over an assertion of theirs
//   (dense heaps). Splitting in the middle (addsteiner_algo 0) does without them.
// - It takes points on edges away again, and follows a null pointer where the edge is that of one triangle
//   only: any open sheet whose border needs a point. Such points stay.
#include "prep/tetgen_recover.hpp"

namespace tetprep {
namespace {

using Face = tetgenmesh::face;
using Pool = tetgenmesh::arraypool;

/// Bounds on how many flips may depend on each other: TetGen begins with 1 and raises that while it helps.
constexpr int most_rounds(OnSurface points) {
  return points == OnSurface::remove ? 20 : 5;
}
constexpr int kFruitlessRounds = 3;

template <class T>
void append(Pool& list, const T& value) {
  T* place = nullptr;
  list.newindex(reinterpret_cast<void**>(&place));
  *place = value;
}

template <class T>
T& at(Pool& list, long i) {
  return *static_cast<T*>(fastlookup((&list), static_cast<int>(i)));
}

/// Moves all of `from` onto `to`.
template <class T>
void hand_over(Pool& from, Pool& to) {
  for (long i = 0; i < from.objects; ++i) append(to, at<T>(from, i));
  from.restart();
}

/// Queues all faces (or segments) of `pool` on `stack` in random order: TetGen's, from its own generator.
void queue_all(tetgenmesh& mesh, tetgenmesh::memorypool& pool, Pool& stack) {
  pool.traversalinit();
  for (long i = 0; i < pool.items; ++i) {
    const auto place = static_cast<long>(mesh.randomnation(static_cast<unsigned>(i + 1)));
    append(stack, Face{});
    at<Face>(stack, i) = at<Face>(stack, place);
    Face next;
    next.sh = mesh.shellfacetraverse(&pool);
    at<Face>(stack, place) = next;
  }
}

/// Calls `recover` (which fills `missing` from `stack`) with bounds that rise as long as that helps.
template <class Recover>
void recover_by_flips(tetgenmesh& mesh, int rounds, Pool& missing, Pool& stack, long total,
                      const Recover& recover) {
  mesh.autofliplinklevel = 1;
  long fewest = total;
  int fruitless = 0;
  for (int round = 0; round < rounds; ++round) {
    recover();
    if (missing.objects == 0) return;
    if (missing.objects < fewest) {
      fewest = missing.objects;
      if (fruitless > 0) --fruitless;
    } else if (++fruitless > kFruitlessRounds) {
      return;
    }
    hand_over<Face>(missing, stack);
    mesh.autofliplinklevel += mesh.b->fliplinklevelinc;
  }
  recover();
}

/// Repeats `recover` as long as fewer are missing afterwards.
template <class Recover>
void recover_while_it_helps(Pool& missing, Pool& stack, const Recover& recover) {
  for (long before = missing.objects + 1; missing.objects > 0 && missing.objects < before;) {
    before = missing.objects;
    hand_over<Face>(missing, stack);
    recover();
  }
}

/// Whether removevertexbyflips() can cope with the surface around `point`.
bool can_be_removed(tetgenmesh& mesh, tetgenmesh::point point) {
  if (mesh.pointtype(point) != tetgenmesh::FREESEGVERTEX) return true;
  Face segment, first, next;
  mesh.sdecode(mesh.point2sh(point), segment);
  segment.shver = 0;
  mesh.spivot(segment, first);
  if (first.sh == nullptr) return false;
  mesh.spivot(first, next);
  return next.sh != nullptr && next.sh != first.sh;
}

/// Tries to take away the points on `points`; those that resist go to `kept`.
void remove_points(tetgenmesh& mesh, Pool& points, Pool& kept, OnSurface how) {
  for (long i = 0; i < points.objects; ++i) {
    const auto point = at<tetgenmesh::point>(points, i);
    if (how == OnSurface::keep || !can_be_removed(mesh, point) || mesh.removevertexbyflips(point) == 0)
      append(kept, point);
  }
  points.restart();
}

/// The facets of the faces, or next to the segments, on `list`.
std::vector<int> facets_of(tetgenmesh& mesh, Pool& list, bool segments) {
  constexpr std::size_t kMost = 20;
  std::vector<int> facets;
  for (long i = 0; i < list.objects && facets.size() < kMost; ++i) {
    Face face = at<Face>(list, i);
    if (segments) mesh.spivot(at<Face>(list, i), face);
    if (face.sh != nullptr) facets.push_back(mesh.shellmark(face) - 1);
  }
  return facets;
}

}  // namespace

void recover_boundary(tetgenmesh& mesh, OnSurface how,
                      const std::function<void(const std::vector<int>&)>& stuck) {
  Pool missing(sizeof(Face), 8), kept(sizeof(tetgenmesh::point), 8);
  const int rounds = most_rounds(how);
  mesh.b->addsteiner_algo = how == OnSurface::remove ? 1 : 0;

  mesh.checksubsegflag = 1;
  queue_all(mesh, *mesh.subsegs, *mesh.subsegstack);
  recover_by_flips(mesh, rounds, missing, *mesh.subsegstack, mesh.subsegs->items,
                   [&] { mesh.recoversegments(&missing, 0, 0); });
  stuck(facets_of(mesh, missing, true));
  // The full search fails by an assertion in dense heaps, and cutting does without it.
  const int full_search = how == OnSurface::remove ? 1 : 0;
  if (full_search != 0) {
    for (int points = 0; points <= 1; ++points)  // without points, then with points in the volume
      recover_while_it_helps(missing, *mesh.subsegstack, [&] { mesh.recoversegments(&missing, 1, points); });
  }
  hand_over<Face>(missing, *mesh.subsegstack);
  mesh.recoversegments(&missing, full_search, 2);  // with points on segments
  if (missing.objects > 0) throw 2;
  remove_points(mesh, *mesh.subvertstack, kept, how);

  mesh.checksubfaceflag = 1;
  queue_all(mesh, *mesh.subfaces, *mesh.subfacstack);
  recover_by_flips(mesh, rounds, missing, *mesh.subfacstack, mesh.subfaces->items,
                   [&] { mesh.recoversubfaces(&missing, 0); });
  stuck(facets_of(mesh, missing, false));
  hand_over<Face>(missing, *mesh.subfacstack);
  if (mesh.subfacstack->objects > 0) mesh.recoversubfaces(nullptr, 1);  // with points on triangles
  remove_points(mesh, *mesh.subvertstack, kept, how);
  remove_points(mesh, kept, *mesh.subvertstack, how);
}

}  // namespace tetprep
