// SPDX-License-Identifier: AGPL-3.0-or-later
// TetGen 1.5 (Si, "TetGen, a Delaunay-based quality tetrahedral mesh generator", ACM TOMS 41(2), 2015),
// driven stage by stage in the order of its own tetrahedralize(). That function owns its mesh on the stack,
// and its error path frees the mesh before it throws, so leaving through it frees everything twice; here the
// mesh is never destroyed, and the process ends instead.
#define TETLIBRARY
#include "prep/tetgen_stages.hpp"

#include <sys/mman.h>
#include <tetgen.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <exception>
#include <new>

namespace tetprep {
namespace {

using Clock = std::chrono::steady_clock;

class Messenger {
 public:
  explicit Messenger(int descriptor) : descriptor_(descriptor) {}

  void send(TetgenMessage::Kind kind, const char* text) const {
    TetgenMessage message;
    message.kind = kind;
    message.seconds = std::chrono::duration<double>(Clock::now() - started_).count();
    message.peak_memory_mb = peak_memory_mb();
    std::strncpy(message.text, text, sizeof message.text - 1);
    if (write(descriptor_, &message, sizeof message) < 0) _exit(1);  // nobody listens any more
  }

  void stage(const char* name) const { send(TetgenMessage::Kind::stage, name); }

 private:
  int descriptor_;
  Clock::time_point started_ = Clock::now();
};

/// The numbers that terminatetetgen() throws.
const char* meaning(int code) {
  switch (code) {
    case 1:
      return "out of memory";
    case 2:
      return "internal error";
    case 3:
      return "two facets intersect";
    case 4:
      return "a feature is too small";
    case 5:
      return "two facets are too close";
    case 10:
      return "refused the input";
    default:
      return "failed for an unknown reason";
  }
}

/// The input in TetGen's form. Its memory is never given back: the process ends soon.
tetgenio* make_input(std::span<const GridPoint> points, std::span<const std::array<Index, 3>> facets) {
  auto* in = new tetgenio;
  in->firstnumber = 0;
  in->numberofpoints = static_cast<int>(points.size());
  in->pointlist = new REAL[points.size() * 3];
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) in->pointlist[3 * i + k] = points[i][k];
  in->numberoffacets = static_cast<int>(facets.size());
  in->facetlist = new tetgenio::facet[facets.size()];
  auto* polygons = new tetgenio::polygon[facets.size()];
  auto* corners = new int[facets.size() * 3];
  for (std::size_t f = 0; f < facets.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) corners[3 * f + k] = static_cast<int>(facets[f][k]);
    polygons[f] = {corners + 3 * f, 3};
    in->facetlist[f] = {polygons + f, 1, nullptr, 0};
  }
  return in;
}

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

/// delaunayrefinement() for a boundary that must not be split, made to end. The original tries a point for
/// each badly shaped tet; most are slivers along the surface, where the boundary forbids one, and where it
/// does not, ever smaller tets follow: bunny00 (75,000 triangles) took 40 s for 194 points, and fandisk_large
/// did not end. But a point is worth having only where tets are large. So: only tets with an edge of a 128th
/// of the scene, only where the point has room, and a bound on the number of trials that TetGen rejects or
/// not (a count, because a clock would make the result depend on the machine). In TetGen's own order: largest
/// first finds the slivers.
void refine(tetgenmesh& mesh) {
  const double least_edge =
      std::max({mesh.xmax - mesh.xmin, mesh.ymax - mesh.ymin, mesh.zmax - mesh.zmin}) / 128;
  const long most_trials = 500 + mesh.subfaces->items / 40;
  constexpr int kOnlyTetrahedra = 4;

  tetgenbehavior& options = *mesh.b;
  mesh.encseglist = new tetgenmesh::arraypool(sizeof(tetgenmesh::face), 8);
  mesh.encshlist = new tetgenmesh::arraypool(sizeof(tetgenmesh::badface), 8);
  mesh.badtetrahedrons =
      new tetgenmesh::memorypool(sizeof(tetgenmesh::triface), options.tetrahedraperblock, sizeof(void*), 0);
  tetgenmesh::triface tet;
  mesh.tetrahedrons->traversalinit();
  while ((tet.tet = mesh.tetrahedrontraverse()) != nullptr) mesh.enqueuetetrahedron(&tet);

  const auto try_to_split = [&](tetgenmesh::triface& bad) {
    REAL centre[3];
    int quality = 0;
    if (!has_edge_of(bad, least_edge * least_edge) || mesh.checktet4split(&bad, quality, centre) == 0 ||
        !has_room(mesh, bad, centre))
      return false;
    mesh.splittetrahedron(&bad, quality, centre, kOnlyTetrahedra);
    return true;
  };
  long trials = 0;
  while (mesh.badtetrahedrons->items > 0 && trials < most_trials) {
    mesh.badtetrahedrons->traversalinit();
    while (auto* queued = static_cast<tetgenmesh::triface*>(mesh.badtetrahedrons->traverse())) {
      if (queued->ver < 0) continue;  // taken before
      if (!mesh.isdeadtet(*queued) && mesh.marktest2ed(*queued)) {
        mesh.unmarktest2(*queued);
        if (trials < most_trials && try_to_split(*queued)) ++trials;
      }
      queued->ver = -1;
      mesh.badtetrahedrons->dealloc(queued);
    }
  }
  // Unmarks what was queued last: that is all it does while no points may be added.
  mesh.steinerleft = 0;
  mesh.repairbadtets(kOnlyTetrahedra);
  mesh.steinerleft = options.steinerleft;
}

void run_stages(tetgenmesh& mesh, const Messenger& messenger) {
  tetgenbehavior& options = *mesh.b;
  clock_t unused = 0;
  messenger.stage("points");
  mesh.initializepools();
  mesh.transfernodes();
  exactinit(options.verbose, options.noexact, options.nostaticfilter, mesh.xmax - mesh.xmin,
            mesh.ymax - mesh.ymin, mesh.zmax - mesh.zmin);
  messenger.stage("delaunay");
  mesh.incrementaldelaunay(unused);
  messenger.stage("surface");
  mesh.meshsurface();
  messenger.stage("boundary recovery");
  mesh.recoverboundary(unused);
  messenger.stage("exterior");
  mesh.carveholes();
  if (mesh.subvertstack->objects > 0) {
    messenger.stage("steiner suppression");
    mesh.suppresssteinerpoints();
  }
  messenger.stage("delaunay recovery");
  mesh.recoverdelaunay();
  if (options.quality != 0) {
    messenger.stage("refinement");
    refine(mesh);
  }
  if (options.optlevel > 0) {
    messenger.stage("optimization");
    mesh.optimizemesh();
  }
}

/// Copies what TetgenMesh holds into the shared memory. Throws std::bad_alloc if that cannot be had.
void write_mesh(tetgenmesh& mesh, std::size_t input_points, int result) {
  // Input points keep their numbers; the pool may have gaps where Steiner points were removed.
  TetgenSizes sizes;
  mesh.points->traversalinit();
  while (tetgenmesh::point point = mesh.pointtraverse())
    mesh.setpointmark(point, static_cast<int>(sizes.points++));
  tetgenmesh::triface tet, beyond;
  mesh.tetrahedrons->traversalinit();
  while ((tet.tet = mesh.tetrahedrontraverse()) != nullptr)
    mesh.setelemindex(tet.tet, static_cast<int>(sizes.tets++));
  if (sizes.points < input_points) throw 2;

  const std::size_t bytes =
      sizeof sizes + sizes.points * sizeof(Point) + 3 * sizes.tets * sizeof(std::array<Index, 4>);
  if (ftruncate(result, static_cast<off_t>(bytes)) != 0) throw std::bad_alloc();
  void* memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, result, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  auto* at = static_cast<std::byte*>(memory);
  const auto put = [&](const auto& value) {
    std::memcpy(at, &value, sizeof value);
    at += sizeof value;
  };
  put(sizes);
  mesh.points->traversalinit();
  while (tetgenmesh::point point = mesh.pointtraverse()) put(Point{point[0], point[1], point[2]});

  // Three passes over the pool, so that each array is written front to back.
  const auto for_each_tet = [&](auto&& row_of) {
    mesh.tetrahedrons->traversalinit();
    while ((tet.tet = mesh.tetrahedrontraverse()) != nullptr) put(row_of());
  };
  const auto for_each_face = [&](auto&& value_of) {
    std::array<Index, 4> row{};
    for (tet.ver = 0; tet.ver < 4; ++tet.ver) {
      // Versions 0 to 3 are the four faces, but not in the order of the vertices that they face.
      const auto* corners = reinterpret_cast<tetgenmesh::point*>(tet.tet + 4);
      const auto opposite = std::find(corners, corners + 4, mesh.oppo(tet)) - corners;
      row[static_cast<std::size_t>(opposite)] = value_of();
    }
    return row;
  };
  for_each_tet([&] {
    std::array<Index, 4> row{};
    for (std::size_t k = 0; k < 4; ++k)
      row[k] = static_cast<Index>(mesh.pointmark(reinterpret_cast<tetgenmesh::point>(tet.tet[4 + k])));
    return row;
  });
  for_each_tet([&] {
    return for_each_face([&] {
      mesh.fsym(tet, beyond);
      return mesh.ishulltet(beyond) ? kNone : static_cast<Index>(mesh.elemindex(beyond.tet));
    });
  });
  for_each_tet([&] {
    return for_each_face([&] {
      tetgenmesh::face facet;
      mesh.tspivot(tet, facet);
      return facet.sh == nullptr ? kNone : static_cast<Index>(mesh.shellmark(facet) - 1);
    });
  });
}

}  // namespace

void run_tetgen(std::span<const GridPoint> points, std::span<const std::array<Index, 3>> facets,
                const std::string& switches, int messages, int result) noexcept {
  const Messenger messenger(messages);
  const auto fail = [&](const char* reason) { messenger.send(TetgenMessage::Kind::failed, reason); };
  try {
    auto* options = new tetgenbehavior;
    if (!options->parse_commandline(const_cast<char*>(switches.c_str()))) return fail("refused its switches");
    // TetGen's bounds without -q: those with -q have it spend its time on angles that matter to no ray
    // (turbine, 18,000 triangles: 22 s of 23).
    options->optmaxdihedral = 179;
    options->optminsmtdihed = options->optminslidihed = 179.999;
    auto* mesh = new tetgenmesh;
    mesh->b = options;
    mesh->in = make_input(points, facets);
    run_stages(*mesh, messenger);
    messenger.stage("hand over");
    write_mesh(*mesh, points.size(), result);
    messenger.send(TetgenMessage::Kind::done, "");
  } catch (int code) {
    fail(meaning(code));
  } catch (const std::bad_alloc&) {
    fail("out of memory");
  } catch (...) {
    fail("failed for an unknown reason");
  }
}

}  // namespace tetprep
