// SPDX-License-Identifier: AGPL-3.0-or-later
// The two trees as tracers.
#include "bench/peers/bvh.hpp"
#include "bench/peers/kd_tree.hpp"
#include "bench/statistics.hpp"
#include "bench/tracer.hpp"

namespace tetbench {
namespace {

template <class Tree>
struct Built {
  std::optional<Tree> tree;
  Structure structure;
  explicit Built(const PeerMesh& mesh) {
    structure.name = Tree::kName;
    structure.build_seconds = process_seconds([&] { tree.emplace(mesh); });
    structure.bytes = tree->bytes();
  }
};

template <class Tree>
class TreeTracer : public Tracer {
 public:
  explicit TreeTracer(Structures& structures)
      : built_(structures.once<Built<Tree>>(Tree::kName, structures.mesh)) {}
  const Structure& structure() const override { return built_->structure; }

  void trace(const RayList& rays, Answers& answers) const override {
    NotCounted counter;
    each(rays, counter, [&](std::size_t i, tetfmt::Index answer) { answers[i] = answer; });
  }
  std::optional<double> visits(const RayList& rays) const override {
    NodeCount counter;
    each(rays, counter, [](std::size_t, tetfmt::Index) {});
    return static_cast<double>(counter.nodes) / static_cast<double>(rays.size());
  }

 private:
  template <class Counter, class Use>
  void each(const RayList& rays, Counter& counter, Use use) const {
    if (rays.occlusion)
      for (std::size_t i = 0; i < rays.size(); ++i) {
        const bool blocked =
            built_->tree->template trace<true>(TreeRay(rays.peer(i)), counter).triangle != tetfmt::kNone;
        use(i, blocked ? kBlocked : tetfmt::kNone);
      }
    else
      for (std::size_t i = 0; i < rays.size(); ++i)
        use(i, built_->tree->template trace<false>(TreeRay(rays.peer(i)), counter).triangle);
  }

  std::shared_ptr<const Built<Tree>> built_;
};

}  // namespace

void add_trees(std::vector<TracerKind>& kinds) {
  kinds.push_back({"bvh", "a SAH bounding volume hierarchy after Pharr, Jakob and Humphreys (2016)",
                   Family::bvh, false, [](Structures& s) { return std::make_unique<TreeTracer<Bvh>>(s); }});
  kinds.push_back({"kd-tree", "a SAH k-d tree after the same", Family::kd_tree, false,
                   [](Structures& s) { return std::make_unique<TreeTracer<KdTree>>(s); }});
}

}  // namespace tetbench
