// SPDX-License-Identifier: AGPL-3.0-or-later
// Embree 3.13: single rays, packets of sixteen, streams; its robust mode.
#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>

#include "bench/statistics.hpp"
#include "bench/text.hpp"
#include "bench/tracer.hpp"
#include "common/failure.hpp"

namespace tetbench {
namespace {

using tetfmt::Index;

/// A scene of high build quality over the mesh, on a device of one thread.
class EmbreeScene {
 public:
  EmbreeScene(const PeerMesh& mesh, bool robust) : numbers_(mesh.numbers) {
    structure_.name = robust ? "Embree, robust" : "Embree";
    device_ = rtcNewDevice("threads=1");
    if (!device_) throw tetprep::Failure(tetprep::ExitCode::runtime, "Embree: no device");
    rtcSetDeviceMemoryMonitorFunction(
        device_,
        [](void* counter, ssize_t bytes, bool) {
          *static_cast<std::atomic<std::int64_t>*>(counter) += bytes;
          return true;
        },
        &bytes_);
    const auto property = [&](RTCDeviceProperty which) { return rtcGetDeviceProperty(device_, which); };
    structure_.version =
        format("%td.%td.%td", property(RTC_DEVICE_PROPERTY_VERSION_MAJOR),
               property(RTC_DEVICE_PROPERTY_VERSION_MINOR), property(RTC_DEVICE_PROPERTY_VERSION_PATCH));
    if (property(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) == 0)
      structure_.version += ", packets of 16 emulated";
    structure_.build_seconds = process_seconds([&] { build(mesh, robust); });
    structure_.bytes = static_cast<std::uint64_t>(bytes_);
  }
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;
  ~EmbreeScene() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  RTCScene scene() const { return scene_; }
  const Structure& structure() const { return structure_; }
  Index triangle(unsigned geometry, unsigned primitive) const {
    return geometry == RTC_INVALID_GEOMETRY_ID ? tetfmt::kNone : numbers_[primitive];
  }

 private:
  void build(const PeerMesh& mesh, bool robust) {
    scene_ = rtcNewScene(device_);
    rtcSetSceneBuildQuality(scene_, RTC_BUILD_QUALITY_HIGH);
    if (robust) rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    std::copy(mesh.vertices.begin(), mesh.vertices.end(),
              static_cast<tetfmt::Vec3f*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                                  RTC_FORMAT_FLOAT3, sizeof(tetfmt::Vec3f),
                                                                  mesh.vertices.size())));
    std::copy(
        mesh.triangles.begin(), mesh.triangles.end(),
        static_cast<std::array<Index, 3>*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(Index), mesh.triangles.size())));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }

  std::vector<Index> numbers_;
  std::atomic<std::int64_t> bytes_ = 0;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  Structure structure_;
};

class EmbreeTracer : public Tracer {
 public:
  explicit EmbreeTracer(std::shared_ptr<const EmbreeScene> scene) : embree_(std::move(scene)) {}
  const Structure& structure() const override { return embree_->structure(); }

 protected:
  static RTCIntersectContext context(const RayList& rays) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (rays.coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    return context;
  }
  static void set(RTCRay& ray, const PeerRay& from) {
    ray.org_x = from.origin.x, ray.org_y = from.origin.y, ray.org_z = from.origin.z;
    ray.dir_x = from.direction.x, ray.dir_y = from.direction.y, ray.dir_z = from.direction.z;
    ray.tnear = from.t_min, ray.tfar = from.t_max;
    ray.time = 0, ray.mask = 0xFFFFFFFF, ray.id = 0, ray.flags = 0;
  }
  static void set(RTCRayHit& query, const PeerRay& from) {
    set(query.ray, from);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  }
  /// Embree tells occlusion by tfar.
  static Index blocked(float tfar) {
    return tfar == -std::numeric_limits<float>::infinity() ? kBlocked : tetfmt::kNone;
  }

  std::shared_ptr<const EmbreeScene> embree_;
};

/// rtcIntersect1 and rtcOccluded1.
class Single : public EmbreeTracer {
 public:
  using EmbreeTracer::EmbreeTracer;
  void trace(const RayList& rays, Answers& answers) const override {
    RTCIntersectContext with = context(rays);
    if (rays.occlusion) {
      for (std::size_t i = 0; i < rays.size(); ++i) {
        RTCRay ray;
        set(ray, rays.peer(i));
        rtcOccluded1(embree_->scene(), &with, &ray);
        answers[i] = blocked(ray.tfar);
      }
      return;
    }
    for (std::size_t i = 0; i < rays.size(); ++i) {
      RTCRayHit query;
      set(query, rays.peer(i));
      rtcIntersect1(embree_->scene(), &with, &query);
      answers[i] = embree_->triangle(query.hit.geomID, query.hit.primID);
    }
  }
};

/// rtcIntersect16 and rtcOccluded16.
class Packets : public EmbreeTracer {
 public:
  using EmbreeTracer::EmbreeTracer;
  void trace(const RayList& rays, Answers& answers) const override {
    RTCIntersectContext with = context(rays);
    for (std::size_t p = 0; p < rays.packets.size(); ++p) {
      const std::size_t begin = p * Packet::kSize, count = std::min(Packet::kSize, rays.size() - begin);
      alignas(64) std::array<int, Packet::kSize> valid{};
      std::fill_n(valid.begin(), count, -1);
      RTCRayHit16 query;
      set(query.ray, rays.packets[p]);
      if (rays.occlusion) {
        rtcOccluded16(valid.data(), embree_->scene(), &with, &query.ray);
        for (std::size_t k = 0; k < count; ++k) answers[begin + k] = blocked(query.ray.tfar[k]);
      } else {
        std::fill_n(query.hit.geomID, Packet::kSize, RTC_INVALID_GEOMETRY_ID);
        std::fill_n(query.hit.instID[0], Packet::kSize, RTC_INVALID_GEOMETRY_ID);
        rtcIntersect16(valid.data(), embree_->scene(), &with, &query);
        for (std::size_t k = 0; k < count; ++k)
          answers[begin + k] = embree_->triangle(query.hit.geomID[k], query.hit.primID[k]);
      }
    }
  }

 private:
  static void set(RTCRay16& ray, const Packet& from) {
    const auto copy = [](const Packet::Lanes& lanes, float* to) {
      std::copy(lanes.begin(), lanes.end(), to);
    };
    copy(from.origin_x, ray.org_x);
    copy(from.origin_y, ray.org_y);
    copy(from.origin_z, ray.org_z);
    copy(from.direction_x, ray.dir_x);
    copy(from.direction_y, ray.dir_y);
    copy(from.direction_z, ray.dir_z);
    copy(from.t_min, ray.tnear);
    copy(from.t_max, ray.tfar);
    std::fill_n(ray.time, Packet::kSize, 0.0F);
    std::fill_n(ray.mask, Packet::kSize, 0xFFFFFFFFU);
    std::fill_n(ray.id, Packet::kSize, 0U);
    std::fill_n(ray.flags, Packet::kSize, 0U);
  }
};

/// rtcIntersect1M and rtcOccluded1M.
class Streams : public EmbreeTracer {
 public:
  using EmbreeTracer::EmbreeTracer;
  void trace(const RayList& rays, Answers& answers) const override {
    RTCIntersectContext with = context(rays);
    std::array<RTCRayHit, kPart> queries;
    for (std::size_t begin = 0; begin < rays.size(); begin += kPart) {
      const std::size_t count = std::min(kPart, rays.size() - begin);
      for (std::size_t i = 0; i < count; ++i) set(queries[i], rays.peer(begin + i));
      if (rays.occlusion) {
        rtcOccluded1M(embree_->scene(), &with, &queries[0].ray, static_cast<unsigned>(count),
                      sizeof(RTCRayHit));
        for (std::size_t i = 0; i < count; ++i) answers[begin + i] = blocked(queries[i].ray.tfar);
      } else {
        rtcIntersect1M(embree_->scene(), &with, queries.data(), static_cast<unsigned>(count),
                       sizeof(RTCRayHit));
        for (std::size_t i = 0; i < count; ++i)
          answers[begin + i] = embree_->triangle(queries[i].hit.geomID, queries[i].hit.primID);
      }
    }
  }

 private:
  static constexpr std::size_t kPart = 256;
};

}  // namespace

void add_embree(std::vector<TracerKind>& kinds) {
  for (const bool robust : {false, true}) {
    const std::string ending = robust ? "-robust" : "", mode = robust ? ", robust mode" : "";
    const Family family = robust ? Family::embree_robust : Family::embree;
    const auto scene = [robust](Structures& structures) {
      return structures.once<EmbreeScene>(robust ? "Embree, robust" : "Embree", structures.mesh, robust);
    };
    kinds.push_back({"embree-1" + ending, "Embree's rtcIntersect1 and rtcOccluded1" + mode, family, false,
                     [scene](Structures& s) { return std::make_unique<Single>(scene(s)); }});
    kinds.push_back({"embree-16" + ending, "Embree's rtcIntersect16 and rtcOccluded16" + mode, family, false,
                     [scene](Structures& s) { return std::make_unique<Packets>(scene(s)); }});
    kinds.push_back({"embree-stream" + ending, "Embree's rtcIntersect1M and rtcOccluded1M" + mode, family,
                     false, [scene](Structures& s) { return std::make_unique<Streams>(scene(s)); }});
  }
}

}  // namespace tetbench
