// SPDX-License-Identifier: AGPL-3.0-or-later
// The camera series of Aman, Demirci and Gudukbay (2022), Table 1: one mesh from seven distances, the last
// one touching its surface. Distances are those at which the mesh's largest extent is 10, measured from the
// middle of its bounds; the camera looks along -z.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "bench/bench.hpp"
#include "bench/statistics.hpp"
#include "bench/text.hpp"
#include "common/output.hpp"

namespace tetbench {

namespace {

using tetfmt::Bounds;
using tetfmt::Ray;
using tetfmt::Vec3f;

class OurTracer : public Tracer {
 public:
  OurTracer(const tetfmt::TrustedView& view, tetfmt::Kernel kernel) : view_(view), kernel_(kernel) {}

  std::string name() const override {
    return std::string(view_.view().layout() == tetfmt::Layout::tet20 ? "Tet20" : "Tet16") +
           (kernel_ == tetfmt::Kernel::exact ? " exact" : " float");
  }

  void trace(std::span<const Ray> rays, Answers& answers) const override {
    const tetfmt::Location start = tetfmt::locate(view_, rays.front().origin);
    for (std::size_t i = 0; i < rays.size(); ++i)
      answers[i] = tetfmt::first_hit(view_, start, rays[i].direction, {}, kernel_).triangle;
  }

  double mean_steps(std::span<const Ray> rays) const {
    const tetfmt::Location start = tetfmt::locate(view_, rays.front().origin);
    double steps = 0;
    for (const Ray& ray : rays) steps += tetfmt::first_hit(view_, start, ray.direction, {}, kernel_).steps;
    return steps / static_cast<double>(rays.size());
  }

 private:
  const tetfmt::TrustedView& view_;
  tetfmt::Kernel kernel_;
};

/// Rays walked together (first_hits), by the exact kernel.
class TogetherTracer : public Tracer {
 public:
  explicit TogetherTracer(const tetfmt::TrustedView& view) : view_(view) {}

  std::string name() const override {
    return std::string(view_.view().layout() == tetfmt::Layout::tet20 ? "Tet20" : "Tet16") +
           " exact, together";
  }

  void trace(std::span<const Ray> rays, Answers& answers) const override {
    const tetfmt::Location start = tetfmt::locate(view_, rays.front().origin);
    std::array<Vec3f, kPart> directions;
    std::array<tetfmt::Hit, kPart> hits;
    for (std::size_t begin = 0; begin < rays.size(); begin += kPart) {
      const std::size_t count = std::min(kPart, rays.size() - begin);
      for (std::size_t i = 0; i < count; ++i) directions[i] = rays[begin + i].direction;
      tetfmt::first_hits(view_, start, std::span(directions).first(count), std::span(hits).first(count));
      for (std::size_t i = 0; i < count; ++i) answers[begin + i] = hits[i].triangle;
    }
  }

 private:
  static constexpr std::size_t kPart = 256;
  const tetfmt::TrustedView& view_;
};

Bounds surface_bounds(const tetfmt::FileView& view) {
  Bounds bounds;
  for (const tetfmt::Triangle& triangle : view.triangles())
    if (!triangle.dropped())
      for (const tetfmt::Index id : triangle.vertices) bounds.add(view.vertices()[id]);
  return bounds;
}

void print(const std::string& text) {
  tetprep::Output::standard().write(text);
}

/// In squares of 16 x 16 pixels, and these in squares of 4 x 4, as renderers shoot them.
std::vector<Ray> camera_rays(const Vec3f& eye, int size, double field_of_view) {
  std::vector<Ray> rays;
  const auto n = static_cast<float>(size);
  const auto half = static_cast<float>(std::tan(field_of_view * std::numbers::pi / 360));
  const auto across = [&](int pixel) { return half * (2 * (static_cast<float>(pixel) + 0.5f) / n - 1); };
  const int tiles = (size + 15) / 16;
  for (int tile = 0; tile < tiles * tiles; ++tile) {
    for (int i = 0; i < 256; ++i) {
      const int block = i / 16, pixel = i % 16;
      const int x = tile % tiles * 16 + block % 4 * 4 + pixel % 4,
                y = tile / tiles * 16 + block / 4 * 4 + pixel / 4;
      if (x < size && y < size) rays.push_back({eye, {across(x), -across(y), -1}});
    }
  }
  return rays;
}

/// The surface's middle, and a tenth of its largest extent.
struct Frame {
  Vec3f middle;
  float unit;
  explicit Frame(const Bounds& box)
      : middle{(box.lower.x + box.upper.x) / 2, (box.lower.y + box.upper.y) / 2,
               (box.lower.z + box.upper.z) / 2},
        unit(std::max({box.upper.x - box.lower.x, box.upper.y - box.lower.y, box.upper.z - box.lower.z}) /
             10) {}
  Vec3f eye(float distance) const { return {middle.x, middle.y, middle.z + distance * unit}; }
};

}  // namespace

std::vector<Ray> camera_view(const tetfmt::FileView& view, float distance, const CameraSeries& options) {
  return camera_rays(Frame(surface_bounds(view)).eye(distance), options.size, options.field_of_view);
}

void camera_series(const tetfmt::TrustedView& view, const tetfmt::TrustedView* other,
                   const CameraSeries& options) {
  const auto [size, repeats, field_of_view] = options;
  const Frame frame(surface_bounds(view.view()));

  std::vector<std::unique_ptr<Tracer>> tracers;
  for (const tetfmt::TrustedView* each : {&view, other}) {
    if (!each) continue;
    tracers.push_back(std::make_unique<OurTracer>(*each, tetfmt::Kernel::float_only));
    tracers.push_back(std::make_unique<OurTracer>(*each, tetfmt::Kernel::exact));
    tracers.push_back(std::make_unique<TogetherTracer>(*each));
  }
  if (auto embree = make_embree(view.view())) {
    tracers.push_back(std::move(embree));
  } else {
    print(format("built without Embree: no ratios to it\n"));
  }
  const bool has_peer = tracers.back()->name().starts_with("Embree");
  const OurTracer& exact =
      static_cast<const OurTracer&>(*tracers[1]);  // the truth that answers are held against

  // Touching: just in front of what the camera's axis meets.
  const Vec3f far_eye = frame.eye(16.5f);
  const Ray axis = {far_eye, {0, 0, -1}};
  const tetfmt::Hit front = tetfmt::first_hit(view, tetfmt::locate(view, far_eye), axis.direction);
  std::vector<float> distances = {16.5f, 14, 11.5f, 9, 6.5f, 4};
  if (front.outcome == tetfmt::Outcome::hit)
    distances.push_back(16.5f - static_cast<float>(front.t) / frame.unit + 0.01f);

  print(format(
      "%d x %d rays a view, one thread, %d repeats in turn; ns a ray, processor time, median (lowest .. "
      "highest)\n",
      size, size, repeats));
  for (const float distance : distances) {
    const std::vector<Ray> rays = camera_rays(frame.eye(distance), size, field_of_view);
    std::vector<std::vector<double>> times(tracers.size());
    std::vector<Answers> answers(tracers.size(), Answers(rays.size()));
    for (int repeat = 0; repeat < repeats; ++repeat)
      for (std::size_t i = 0; i < tracers.size(); ++i)
        times[i].push_back(seconds([&] { tracers[i]->trace(rays, answers[i]); }) * 1e9 /
                           static_cast<double>(rays.size()));

    const auto hits =
        std::count_if(answers[1].begin(), answers[1].end(), [](auto id) { return id != tetfmt::kNone; });
    print(format("\ndistance %.2f: %.1f tets a ray, %.1f %% of the rays hit\n", static_cast<double>(distance),
                 exact.mean_steps(rays),
                 100.0 * static_cast<double>(hits) / static_cast<double>(rays.size())));
    for (std::size_t i = 0; i < tracers.size(); ++i) {
      std::size_t different = 0;
      for (std::size_t k = 0; k < rays.size(); ++k) different += answers[i][k] != answers[1][k];
      print(format("  %-22s %-28s", tracers[i]->name().c_str(), text(summarize(times[i]), 0).c_str()));
      if (has_peer) print(format(" / Embree %-22s", text(ratio(times[i], times.back()), 2).c_str()));
      print(format(" other answers than exact: %zu\n", different));
    }
    print(format("  %-22s %s\n", "exact / float", text(ratio(times[1], times[0]), 2).c_str()));
  }
}

}  // namespace tetbench
