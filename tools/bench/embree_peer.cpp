// SPDX-License-Identifier: AGPL-3.0-or-later
#include <embree3/rtcore.h>

#include <limits>

#include "bench/bench.hpp"
#include "common/failure.hpp"

namespace tetbench {
namespace {

class Embree : public Tracer {
 public:
  Embree(const tetfmt::FileView& view, bool robust) : robust_(robust), device_(rtcNewDevice(nullptr)) {
    if (!device_) throw tetprep::Failure(tetprep::ExitCode::runtime, "Embree: no device");
    scene_ = rtcNewScene(device_);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    if (robust) rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    const auto vertices = view.vertices();
    auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(tetfmt::Vec3f), vertices.size()));
    for (const tetfmt::Vec3f& p : vertices) {
      *points++ = p.x;
      *points++ = p.y;
      *points++ = p.z;
    }
    const auto triangles = view.input_triangles();
    auto* corners = static_cast<tetfmt::Index*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(tetfmt::Triangle), triangles.size()));
    for (const tetfmt::Triangle& triangle : triangles) {
      bool whole = true;  // files that leave space out may lack corners
      for (const tetfmt::Index id : triangle.vertices) whole = whole && id < vertices.size();
      for (const tetfmt::Index id : triangle.vertices) *corners++ = whole ? id : 0;
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
  ~Embree() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  std::string name() const override {
    return robust_ ? "Embree rtcIntersect1, robust" : "Embree rtcIntersect1";
  }

  void trace(std::span<const tetfmt::Ray> rays, Answers& answers) const override {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;  // its best case: neighbours on the image
    for (std::size_t i = 0; i < rays.size(); ++i) {
      RTCRayHit query{};
      const auto& [origin, direction] = rays[i];
      query.ray.org_x = origin.x, query.ray.org_y = origin.y, query.ray.org_z = origin.z;
      query.ray.dir_x = direction.x, query.ray.dir_y = direction.y, query.ray.dir_z = direction.z;
      query.ray.tfar = std::numeric_limits<float>::infinity();
      query.ray.mask = 0xFFFFFFFF;
      query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene_, &context, &query);
      answers[i] = query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? tetfmt::kNone : query.hit.primID;
    }
  }

 private:
  bool robust_;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
};

}  // namespace

std::unique_ptr<Tracer> make_embree(const tetfmt::FileView& view, bool robust) {
  return std::make_unique<Embree>(view, robust);
}

}  // namespace tetbench
