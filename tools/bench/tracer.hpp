// SPDX-License-Identifier: AGPL-3.0-or-later
// What `tet bench` measures: tracers, behind one small interface. To add one: a class here or in a file of
// its own, and an entry in one of the add_ functions at the end.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/peer_mesh.hpp"
#include "bench/ray_list.hpp"
#include "bench/scene.hpp"

namespace tetbench {

/// Of each ray: the input triangle that it meets first, or kNone. Asked for occlusion: kNone if nothing is in
/// the way, else kBlocked.
using Answers = std::vector<tetfmt::Index>;
inline constexpr tetfmt::Index kBlocked = 0;

/// What is built once a mesh, and traced ever after.
struct Structure {
  std::string name;          ///< tracers that share a structure share its name
  std::string version = {};  ///< of the library that it is of, if it is not of this project
  std::uint64_t bytes = 0;   ///< in memory while it is traced, vertices and triangles included
  double build_seconds = 0;  ///< processor time; 0: not built but opened
};

class Tracer {
 public:
  virtual ~Tracer() = default;
  /// Whether it takes such rays at all.
  virtual bool takes(const RayList&) const { return true; }
  /// `answers` has the list's size. Any thread may trace.
  virtual void trace(const RayList& rays, Answers& answers) const = 0;
  /// Nodes or tetrahedra that are visited for a ray, on average: from the same code, compiled to count.
  virtual std::optional<double> visits(const RayList&) const { return std::nullopt; }
  virtual const Structure& structure() const = 0;
  /// More rays than this take too long: then it is asked a sample.
  virtual std::size_t most_rays() const { return SIZE_MAX; }
};

/// What tracers are made from, and what they share: one mesh, and every structure over it built once.
class Structures {
 public:
  /// `of` must outlive this.
  explicit Structures(const Scene& of) : scene(of), mesh(of.view(0).view()) {}

  const Scene& scene;
  const PeerMesh mesh;

  /// The structure of that name; made of the arguments the first time.
  template <class T, class... Arguments>
  std::shared_ptr<const T> once(const std::string& name, Arguments&&... arguments) {
    auto& place = built_[name];
    if (!place) place = std::make_shared<const T>(std::forward<Arguments>(arguments)...);
    return std::static_pointer_cast<const T>(place);
  }

 private:
  std::map<std::string, std::shared_ptr<const void>> built_;
};

/// Whose it is: pictures give each its colour.
enum class Family : std::uint8_t { tet20, tet16, embree, embree_robust, bvh, kd_tree, cgal };

struct TracerKind {
  std::string name, description;
  Family family;
  bool exact;  ///< must agree with the exact kernel on every ray
  std::function<std::unique_ptr<Tracer>(Structures&)> make;
};

/// All that this build has, ours first.
std::vector<TracerKind> tracer_kinds();

void add_ours(std::vector<TracerKind>& kinds);
void add_trees(std::vector<TracerKind>& kinds);
void add_embree(std::vector<TracerKind>& kinds);  ///< where Embree is built in
void add_cgal(std::vector<TracerKind>& kinds);    ///< where CGAL is

}  // namespace tetbench
