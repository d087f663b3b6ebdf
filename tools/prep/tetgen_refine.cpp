// SPDX-License-Identifier: AGPL-3.0-or-later
// TetGen's own refinement serves finite elements. It tries to mend every badly shaped tet, and refuses a
// point that comes into the diametral sphere of a boundary triangle. With a boundary that must not be split,
// most bad tets are slivers along it that nothing mends, and most points are refused after all the work to
// place them: bunny00 (75,000 triangles) took 40 s for 194 points, and fandisk_large did not end.
//
// Rays want something else: no large faces in empty space. So a point is tried only for tets that are large,
// where it has room, and TetGen's refusal is switched off: then nearly every trial succeeds, and the number
// of points is the only bound that is needed. Random lines cross 50 tets of bunny00, where they crossed 103
// (133 without points).
#include "prep/tetgen_refine.hpp"

#include <algorithm>

namespace tetprep {
namespace {

constexpr int kCheckTetrahedra = 4;  ///< chkencflag: new tets are queued in badtetrahedrons

const REAL* corner(const tetgenmesh::triface& tet, int i) {
  return reinterpret_cast<const REAL*>(tet.tet[4 + i]);
}

double squared_distance(const REAL* a, const REAL* b) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return sum;
}

bool has_edge_of(const tetgenmesh::triface& tet, double squared_least) {
  for (int i = 0; i < 4; ++i)
    for (int j = i + 1; j < 4; ++j)
      if (squared_distance(corner(tet, i), corner(tet, j)) >= squared_least) return true;
  return false;
}

/// Whether a new point can stand at `centre`, the circumcentre of `tet`: the way there does not cross the
/// boundary, and the tet there has no corner nearer than half the circumradius.
bool has_room(tetgenmesh& mesh, tetgenmesh::triface tet, REAL* centre) {
  const double squared_least = squared_distance(centre, corner(tet, 0)) / 4;
  constexpr int kMostSteps = 1000;  // the walk might go in circles where the mesh is not Delaunay
  for (int step = 0; step < kMostSteps; ++step) {
    tetgenmesh::triface beyond;
    for (tet.ver = 0; tet.ver < 4 && beyond.tet == nullptr; ++tet.ver) {
      if (orient3d(mesh.org(tet), mesh.dest(tet), mesh.apex(tet), centre) <= 0) continue;
      tetgenmesh::face facet;
      mesh.tspivot(tet, facet);
      if (facet.sh != nullptr) return false;
      mesh.fsym(tet, beyond);
      if (mesh.ishulltet(beyond)) return false;
    }
    if (beyond.tet == nullptr) {
      for (int i = 0; i < 4; ++i)
        if (squared_distance(centre, corner(tet, i)) < squared_least) return false;
      return true;
    }
    tet = beyond;
  }
  return false;
}

/// splittetrahedron() without the refusal: rejflag stays 0.
void insert_at(tetgenmesh& mesh, const REAL* centre, const tetgenmesh::triface& bad) {
  tetgenmesh::point point = nullptr;
  mesh.makepoint(&point, tetgenmesh::FREEVOLVERTEX);
  std::copy_n(centre, 3, point);
  tetgenmesh::insertvertexflags how;
  how.iloc = static_cast<int>(tetgenmesh::OUTSIDE);
  how.bowywat = 3;  // Bowyer and Watson's cavity, but not across segments and triangles
  how.lawson = 2;
  how.chkencflag = kCheckTetrahedra;
  how.validflag = how.respectbdflag = 1;
  how.refineflag = 1;
  how.refinetet = bad;
  tetgenmesh::triface start = bad;
  if (mesh.insertpoint(point, &start, nullptr, nullptr, &how) == 0) {
    mesh.pointdealloc(point);
    return;
  }
  ++mesh.st_volref_count;
  if (mesh.flipstack == nullptr) return;
  tetgenmesh::flipconstraints flips;
  flips.chkencflag = kCheckTetrahedra;
  flips.enqflag = 2;
  mesh.lawsonflip3d(&flips);
  mesh.unflipqueue->restart();
}

}  // namespace

void refine_empty_space(tetgenmesh& mesh) {
  const double least_edge =
      std::max({mesh.xmax - mesh.xmin, mesh.ymax - mesh.ymin, mesh.zmax - mesh.zmin}) / 128;
  // A count, not a clock: the result must not depend on the machine. A trial may take milliseconds, because
  // in empty space a cavity has thousands of tets.
  long trials_left = 300 + mesh.subfaces->items / 100;

  mesh.encseglist = new tetgenmesh::arraypool(sizeof(tetgenmesh::face), 8);
  mesh.encshlist = new tetgenmesh::arraypool(sizeof(tetgenmesh::badface), 8);
  mesh.badtetrahedrons =
      new tetgenmesh::memorypool(sizeof(tetgenmesh::triface), mesh.b->tetrahedraperblock, sizeof(void*), 0);
  tetgenmesh::triface tet;
  mesh.tetrahedrons->traversalinit();
  while ((tet.tet = mesh.tetrahedrontraverse()) != nullptr) mesh.enqueuetetrahedron(&tet);

  const auto try_to_split = [&](tetgenmesh::triface& bad) {
    REAL centre[3];
    int quality = 0;
    if (!has_edge_of(bad, least_edge * least_edge) || mesh.checktet4split(&bad, quality, centre) == 0 ||
        !has_room(mesh, bad, centre))
      return;
    --trials_left;
    insert_at(mesh, centre, bad);
  };
  // In TetGen's order, which is spread over the scene. Largest first is worse: it spends its trials on
  // slivers with immense spheres.
  while (mesh.badtetrahedrons->items > 0 && trials_left > 0) {
    mesh.badtetrahedrons->traversalinit();
    while (auto* queued = static_cast<tetgenmesh::triface*>(mesh.badtetrahedrons->traverse())) {
      if (queued->ver < 0) continue;  // taken before
      if (!mesh.isdeadtet(*queued) && mesh.marktest2ed(*queued)) {
        mesh.unmarktest2(*queued);
        if (trials_left > 0) try_to_split(*queued);
      }
      queued->ver = -1;
      mesh.badtetrahedrons->dealloc(queued);
    }
  }
  // Unmarks what was queued last: that is all it does while no points may be added.
  mesh.steinerleft = 0;
  mesh.repairbadtets(kCheckTetrahedra);
  mesh.steinerleft = mesh.b->steinerleft;
}

}  // namespace tetprep
