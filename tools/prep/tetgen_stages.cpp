// SPDX-License-Identifier: AGPL-3.0-or-later
// TetGen 1.5 (Si, "TetGen, a Delaunay-based quality tetrahedral mesh generator", ACM TOMS 41(2), 2015),
// driven stage by stage in the order of its own tetrahedralize(). That function owns its mesh on the stack,
// and its error path frees the mesh before it throws, so leaving through it frees everything twice; here the
// mesh is never destroyed, and the process ends instead.
#include "prep/tetgen_stages.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <exception>
#include <new>
#include <vector>

#include "prep/tetgen_recover.hpp"
#include "prep/tetgen_refine.hpp"

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

  void stuck(const std::vector<int>& facets) const {
    TetgenMessage message;
    message.kind = TetgenMessage::Kind::stuck;
    message.facet_count = static_cast<std::int32_t>(std::min(facets.size(), message.facets.size()));
    std::copy_n(facets.begin(), message.facet_count, message.facets.begin());
    if (write(descriptor_, &message, sizeof message) < 0) _exit(1);
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
      return kOutOfMemory;
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

void run_stages(tetgenmesh& mesh, bool may_cut, const Messenger& messenger) {
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
  recover_boundary(mesh, may_cut ? OnSurface::keep : OnSurface::remove,
                   [&](const std::vector<int>& facets) { messenger.stuck(facets); });
  messenger.stage("exterior");
  mesh.carveholes();
  if (may_cut) {
    mesh.subvertstack->restart();
  } else if (mesh.subvertstack->objects > 0) {
    messenger.stage("steiner suppression");
    mesh.suppresssteinerpoints();
  }
  messenger.stage("delaunay recovery");
  mesh.recoverdelaunay();
  if (options.quality != 0) {
    messenger.stage("refinement");
    refine_empty_space(mesh);
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
                const TetgenCall& call, int messages, int result) noexcept {
  const Messenger messenger(messages);
  const auto fail = [&](const char* reason) { messenger.send(TetgenMessage::Kind::failed, reason); };
  try {
    auto* options = new tetgenbehavior;
    if (!options->parse_commandline(const_cast<char*>(call.switches.c_str())))
      return fail("refused its switches");
    // TetGen's bounds without -q: those with -q have it spend its time on angles that matter to no ray
    // (turbine, 18,000 triangles: 22 s of 23).
    options->optmaxdihedral = 179;
    options->optminsmtdihed = options->optminslidihed = 179.999;
    auto* mesh = new tetgenmesh;
    mesh->b = options;
    mesh->in = make_input(points, facets);
    run_stages(*mesh, call.may_cut, messenger);
    messenger.stage("hand over");
    write_mesh(*mesh, points.size(), result);
    messenger.send(TetgenMessage::Kind::done, "");
  } catch (int code) {
    fail(meaning(code));
  } catch (const std::bad_alloc&) {
    fail(kOutOfMemory);
  } catch (...) {
    fail("failed for an unknown reason");
  }
}

}  // namespace tetprep
