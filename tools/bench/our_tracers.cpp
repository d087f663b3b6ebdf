// SPDX-License-Identifier: AGPL-3.0-or-later
// The library's own ways to answer rays.
#include <algorithm>
#include <array>

#include "bench/tracer.hpp"
#include "tetfmt/batch.hpp"
#include "tetfmt/kernels.hpp"

namespace tetbench {
namespace {

using tetfmt::Arithmetic;
using tetfmt::Basis;
using tetfmt::Hit;
using tetfmt::Index;
using tetfmt::Kernel;
using tetfmt::Layout;
using tetfmt::Outcome;

class Ours : public Tracer {
 public:
  Ours(const Structures& structures, Layout layout)
      : view_(structures.scene.view(structures.scene.view(0).view().layout() == layout ? 0 : 1)) {
    structure_.name = layout == Layout::tet20 ? "Tet20" : "Tet16";
    for (const tetfmt::SectionKind kind :
         {tetfmt::kVertices, tetfmt::kTets, tetfmt::kSources, tetfmt::kSides, tetfmt::kTriangles,
          tetfmt::kHullFaces, tetfmt::kSurfaceBounds, tetfmt::kOrigins, tetfmt::kInputTriangles})
      structure_.bytes += view_.view().section(kind).size();
  }
  const Structure& structure() const override { return structure_; }

 protected:
  const tetfmt::TrustedView& view_;
  Structure structure_;
};

Index answer(Outcome outcome) {
  return outcome == Outcome::hit ? kBlocked : tetfmt::kNone;
}

/// One ray at a time, as renderers ask.
class Single : public Ours {
 public:
  Single(const Structures& structures, Layout layout, Kernel kernel)
      : Ours(structures, layout), kernel_(kernel) {}

  /// Occlusion has the exact kernel only.
  bool takes(const RayList& rays) const override { return !rays.occlusion || kernel_ == Kernel::exact; }

  void trace(const RayList& rays, Answers& answers) const override {
    if (!rays.to.empty()) {
      for (std::size_t i = 0; i < rays.size(); ++i)
        answers[i] = answer(tetfmt::occlusion(view_, rays.places[rays.from[i]], rays.places[rays.to[i]]));
    } else if (rays.occlusion) {
      for (std::size_t i = 0; i < rays.size(); ++i)
        answers[i] = answer(tetfmt::occlusion(view_, rays.places[rays.from[i]], rays.directions[i],
                                              {0, static_cast<double>(rays.t_max[i])}));
    } else {
      for (std::size_t i = 0; i < rays.size(); ++i) answers[i] = first_hit(rays, i).triangle;
    }
  }

  std::optional<double> visits(const RayList& rays) const override {
    if (rays.occlusion) return std::nullopt;  // an outcome has no steps
    double steps = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) steps += first_hit(rays, i).steps;
    return steps / static_cast<double>(rays.size());
  }

 private:
  Hit first_hit(const RayList& rays, std::size_t i) const {
    return tetfmt::first_hit(view_, rays.places[rays.from[i]], rays.directions[i],
                             {0, static_cast<double>(rays.t_max[i])}, kernel_);
  }
  Kernel kernel_;
};

/// The other arithmetics and bases.
class Varied : public Ours {
 public:
  Varied(const Structures& structures, Layout layout, tetfmt::Variant variant)
      : Ours(structures, layout), variant_(variant) {}

  bool takes(const RayList& rays) const override { return !rays.occlusion && rays.unbounded(); }
  void trace(const RayList& rays, Answers& answers) const override {
    for (std::size_t i = 0; i < rays.size(); ++i) answers[i] = first_hit(rays, i).triangle;
  }
  std::optional<double> visits(const RayList& rays) const override {
    double steps = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) steps += first_hit(rays, i).steps;
    return steps / static_cast<double>(rays.size());
  }

 private:
  Hit first_hit(const RayList& rays, std::size_t i) const {
    return tetfmt::first_hit(view_, rays.places[rays.from[i]], rays.directions[i], variant_);
  }
  tetfmt::Variant variant_;
};

/// Rays of one origin, walked together; segments to one place, from there.
class Together : public Ours {
 public:
  using Ours::Ours;
  bool takes(const RayList& rays) const override {
    if (!rays.to.empty())
      return std::all_of(rays.to.begin(), rays.to.end(), [&](auto to) { return to == rays.to[0]; });
    return rays.one_origin() && !rays.occlusion && rays.unbounded();
  }
  void trace(const RayList& rays, Answers& answers) const override { count_visits(rays, answers); }
  std::optional<double> visits(const RayList& rays) const override {
    Answers answers(rays.size());
    return static_cast<double>(count_visits(rays, answers)) / static_cast<double>(rays.size());
  }

 private:
  static constexpr std::size_t kPart = 1024;
  std::uint64_t count_visits(const RayList& rays, Answers& answers) const {
    std::array<Hit, kPart> hits;
    std::array<Outcome, kPart> outcomes;
    std::vector<tetfmt::Location> gathered;
    std::uint64_t visited = 0;
    for (std::size_t begin = 0; begin < rays.size(); begin += kPart) {
      const std::size_t count = std::min(kPart, rays.size() - begin);
      if (rays.to.empty()) {
        visited += tetfmt::first_hits(view_, rays.places[0], std::span(rays.directions).subspan(begin, count),
                                      std::span(hits).first(count));
        for (std::size_t i = 0; i < count; ++i) answers[begin + i] = hits[i].triangle;
      } else {
        const auto from = std::span(rays.from).subspan(begin, count);
        std::span<const tetfmt::Location> targets(gathered);
        if (std::adjacent_find(from.begin(), from.end(), [](auto i, auto j) { return j != i + 1; }) ==
            from.end()) {
          targets = std::span(rays.places).subspan(from[0], count);
        } else {
          gathered.clear();
          for (const std::uint32_t i : from) gathered.push_back(rays.places[i]);
          targets = gathered;
        }
        visited +=
            tetfmt::occlusions(view_, rays.places[rays.to[0]], targets, std::span(outcomes).first(count));
        for (std::size_t i = 0; i < count; ++i) answers[begin + i] = answer(outcomes[i]);
      }
    }
    return visited;
  }
};

/// Rays of any places, walked side by side (trace_batch, occlude_batch).
class Batch : public Ours {
 public:
  using Ours::Ours;
  void trace(const RayList& rays, Answers& answers) const override {
    if (!rays.to.empty())
      each_part<tetfmt::BatchSegment, Outcome>(rays, answers, [&](std::size_t i) {
        return tetfmt::BatchSegment{rays.from[i], rays.to[i]};
      });
    else if (rays.occlusion)
      each_part<tetfmt::BatchRay, Outcome>(rays, answers, [&](std::size_t i) { return ray(rays, i); });
    else
      each_part<tetfmt::BatchRay, Hit>(rays, answers, [&](std::size_t i) { return ray(rays, i); });
  }

 private:
  static constexpr std::size_t kPart = 1024;
  static tetfmt::BatchRay ray(const RayList& rays, std::size_t i) {
    return {rays.from[i], rays.directions[i], {0, double{rays.t_max[i]}}};
  }
  template <class Query, class Result, class Make>
  void each_part(const RayList& rays, Answers& answers, Make make) const {
    std::vector<Query> queries(kPart);
    std::vector<Result> results(kPart);
    for (std::size_t begin = 0; begin < rays.size(); begin += kPart) {
      const std::size_t count = std::min(kPart, rays.size() - begin);
      for (std::size_t i = 0; i < count; ++i) queries[i] = make(begin + i);
      const auto asked = std::span<const Query>(queries).first(count);
      const auto told = std::span(results).first(count);
      if constexpr (std::is_same_v<Result, Hit>) {
        tetfmt::trace_batch(view_, rays.places, asked, told);
        for (std::size_t i = 0; i < count; ++i) answers[begin + i] = told[i].triangle;
      } else {
        tetfmt::occlude_batch(view_, rays.places, asked, told);
        for (std::size_t i = 0; i < count; ++i) answers[begin + i] = answer(told[i]);
      }
    }
  }
};

}  // namespace

void add_ours(std::vector<TracerKind>& kinds) {
  struct Variation {
    const char *name, *description;
    tetfmt::Variant variant;
  };
  static constexpr Variation kVariations[] = {
      {"float-first",
       "signs in float32 with an error bound, then as exact",
       {Arithmetic::float_first, Basis::shear}},
      {"exact-orthonormal",
       "exact, onto two orthogonal unit vectors",
       {Arithmetic::exact, Basis::orthonormal}},
      {"exact-specialised", "exact, onto the basis of appendix C", {Arithmetic::exact, Basis::specialised}},
      {"float-orthonormal",
       "float32 as it comes, two orthogonal unit vectors",
       {Arithmetic::float_only, Basis::orthonormal}},
      {"float-specialised",
       "float32 as it comes, the basis of appendix C",
       {Arithmetic::float_only, Basis::specialised}},
  };
  for (const Layout layout : {Layout::tet20, Layout::tet16}) {
    const bool is_tet20 = layout == Layout::tet20;
    const std::string prefix = is_tet20 ? "tet20-" : "tet16-";
    const Family family = is_tet20 ? Family::tet20 : Family::tet16;
    const auto add = [&](const std::string& name, const std::string& description, bool exact, auto make) {
      kinds.push_back({prefix + name, description, family, exact, make});
    };
    add("exact", "the exact kernel, one ray at a time", true,
        [layout](Structures& s) { return std::make_unique<Single>(s, layout, Kernel::exact); });
    add("float", "the float kernel, one ray at a time", false,
        [layout](Structures& s) { return std::make_unique<Single>(s, layout, Kernel::float_only); });
    add("together",
        "exact, rays from one place walked together (first_hits); those to a light, from the light "
        "(occlusions)",
        true, [layout](Structures& s) { return std::make_unique<Together>(s, layout); });
    add("batch", "exact, rays of any places walked side by side (trace_batch, occlude_batch)", true,
        [layout](Structures& s) { return std::make_unique<Batch>(s, layout); });
    if (!is_tet20) continue;  // what differs between the layouts does not depend on these
    for (const Variation& each : kVariations)
      add(each.name, each.description, each.variant.arithmetic != Arithmetic::float_only,
          [layout, variant = each.variant](Structures& s) {
            return std::make_unique<Varied>(s, layout, variant);
          });
  }
}

}  // namespace tetbench
