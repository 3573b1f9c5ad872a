// Embree 3 (Debian 12) or 4 (Debian 13): rtcInterpolateN on a subdivision mesh, rtcIntersect16 on triangles. The build script
// defines CATOPTRIC_EMBREE as the version that it links.
#include "embree.h"
#include "guard.hpp"

#if CATOPTRIC_EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <pmmintrin.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>
#include <string>
#include <thread>
#include <vector>

using namespace catoptric;

namespace {

struct Device {
    RTCDevice device;
    RTCScene scene = nullptr;
    RTCGeometry geometry = nullptr;

    explicit Device(int threads)
        : device(rtcNewDevice(("threads=" + std::to_string(threads)).c_str())) {
        if (!device) throw std::runtime_error("Embree gives no device");
    }
    Device(Device const &) = delete;
    ~Device() {
        if (geometry) rtcReleaseGeometry(geometry);
        if (scene) rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }

    void check() const {
        if (rtcGetDeviceError(device) != RTC_ERROR_NONE) throw std::runtime_error("Embree reports an error");
    }

    // Room for an array that Embree owns, filled from `source`.
    template <class T>
    void copy(RTCBufferType type, RTCFormat format, std::size_t width, T const *source, std::size_t count) {
        if (count == 0) return;
        void *to = rtcSetNewGeometryBuffer(geometry, type, 0, format, width * sizeof(T), count);
        check();
        std::memcpy(to, source, width * count * sizeof(T));
    }

    void commit() {
        rtcCommitGeometry(geometry);
        scene = rtcNewScene(device);
        rtcAttachGeometry(scene, geometry);
        rtcCommitScene(scene);
        check();
    }
};

RTCSubdivisionMode mode_of(osd_boundary boundary) {
    switch (boundary) {
    case OSD_BOUNDARY_NONE: return RTC_SUBDIVISION_MODE_NO_BOUNDARY;
    case OSD_BOUNDARY_EDGE_ONLY: return RTC_SUBDIVISION_MODE_SMOOTH_BOUNDARY;
    case OSD_BOUNDARY_EDGE_AND_CORNER: return RTC_SUBDIVISION_MODE_PIN_CORNERS;
    }
    throw std::invalid_argument("unknown boundary rule");
}

// What Embree's manual asks of threads that call it: denormal numbers are zero.
struct FlushToZero {
    unsigned const before = _mm_getcsr();
    FlushToZero() {
        _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
        _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    }
    FlushToZero(FlushToZero const &) = delete;
    ~FlushToZero() { _mm_setcsr(before); }
};

// Packets of coherent rays, as each version of Embree is told of them.
struct Query {
#if CATOPTRIC_EMBREE == 4
    RTCIntersectArguments arguments;
    Query() {
        rtcInitIntersectArguments(&arguments);
        arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    }
    void intersect(int const *valid, RTCScene scene, RTCRayHit16 *packet) {
        rtcIntersect16(valid, scene, packet, &arguments);
    }
#else
    RTCIntersectContext context;
    Query() {
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    }
    void intersect(int const *valid, RTCScene scene, RTCRayHit16 *packet) {
        rtcIntersect16(valid, scene, &context, packet);
    }
#endif
};

constexpr int32_t SIDE = 4; // a packet is SIDE * SIDE pixels

// How many of the rays through the pixels from (x,y) hit.
int64_t trace_packet(RTCScene scene, Query &query, emb_camera const &camera, int32_t x, int32_t y,
                     float *depths) {
    RTCRayHit16 packet{};
    alignas(64) int valid[SIDE * SIDE];
    for (int32_t i = 0; i < SIDE * SIDE; ++i) {
        int32_t const px = x + i % SIDE, py = y + i / SIDE;
        valid[i] = px < camera.width && py < camera.height ? -1 : 0;
        float direction[3];
        for (int k = 0; k < 3; ++k)
            direction[k] =
                camera.first[k] + float(px) * camera.right[k] + float(py) * camera.down[k] - camera.eye[k];
        packet.ray.org_x[i] = camera.eye[0];
        packet.ray.org_y[i] = camera.eye[1];
        packet.ray.org_z[i] = camera.eye[2];
        packet.ray.dir_x[i] = direction[0];
        packet.ray.dir_y[i] = direction[1];
        packet.ray.dir_z[i] = direction[2];
        packet.ray.tfar[i] = std::numeric_limits<float>::infinity();
        packet.ray.mask[i] = ~0u;
        packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
    query.intersect(valid, scene, &packet);
    int64_t met = 0;
    for (int32_t i = 0; i < SIDE * SIDE; ++i) {
        if (!valid[i]) continue;
        std::size_t const row = std::size_t(y + i / SIDE);
        depths[row * std::size_t(camera.width) + std::size_t(x + i % SIDE)] = packet.ray.tfar[i];
        met += packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
    }
    return met;
}

} // namespace

struct emb_subdivision : Device {
    using Device::Device;
};
struct emb_triangles : Device {
    using Device::Device;
};

extern "C" {

osd_status emb_subdivision_create(const osd_mesh *mesh, const double *points, emb_subdivision **out) {
    return create(out, [&] {
        auto made = std::make_unique<emb_subdivision>(1);
        made->geometry = rtcNewGeometry(made->device, RTC_GEOMETRY_TYPE_SUBDIVISION);
        // Embree loads whole vectors, and its assertions read the fourth number: it must be there, and valid.
        std::vector<float> padded(4 * std::size_t(mesh->vertex_count));
        for (std::size_t i = 0; i < std::size_t(mesh->vertex_count); ++i)
            for (std::size_t k = 0; k < 3; ++k) padded[4 * i + k] = float(points[3 * i + k]);
        std::size_t corners = 0;
        for (int32_t face = 0; face < mesh->face_count; ++face) corners += std::size_t(mesh->face_sizes[face]);
        made->copy(RTC_BUFFER_TYPE_FACE, RTC_FORMAT_UINT, 1, mesh->face_sizes, std::size_t(mesh->face_count));
        made->copy(RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT, 1, mesh->face_vertices, corners);
        made->copy(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, 4, padded.data(), std::size_t(mesh->vertex_count));
        made->copy(RTC_BUFFER_TYPE_EDGE_CREASE_INDEX, RTC_FORMAT_UINT2, 2, mesh->crease_vertices,
                   std::size_t(mesh->crease_count));
        made->copy(RTC_BUFFER_TYPE_EDGE_CREASE_WEIGHT, RTC_FORMAT_FLOAT, 1, mesh->crease_sharpness,
                   std::size_t(mesh->crease_count));
        made->copy(RTC_BUFFER_TYPE_VERTEX_CREASE_INDEX, RTC_FORMAT_UINT, 1, mesh->corner_vertices,
                   std::size_t(mesh->corner_count));
        made->copy(RTC_BUFFER_TYPE_VERTEX_CREASE_WEIGHT, RTC_FORMAT_FLOAT, 1, mesh->corner_sharpness,
                   std::size_t(mesh->corner_count));
        made->copy(RTC_BUFFER_TYPE_HOLE, RTC_FORMAT_UINT, 1, mesh->holes, std::size_t(mesh->hole_count));
        rtcSetGeometrySubdivisionMode(made->geometry, 0, mode_of(mesh->boundary));
        made->commit();
        return made;
    });
}

void emb_subdivision_destroy(emb_subdivision *subdivision) { delete subdivision; }

osd_status emb_subdivision_evaluate(const emb_subdivision *subdivision, int32_t count, const uint32_t *faces,
                                    const float *u, const float *v, float *out) {
    return guard([&] {
        FlushToZero const flush;
        RTCInterpolateNArguments arguments{};
        arguments.geometry = subdivision->geometry;
        arguments.bufferType = RTC_BUFFER_TYPE_VERTEX;
        arguments.valueCount = 3;
        for (int32_t first = 0; first < count; first += EMB_BATCH, out += 9 * EMB_BATCH) {
            arguments.primIDs = faces + first;
            arguments.u = u + first;
            arguments.v = v + first;
            arguments.N = unsigned(std::min<int32_t>(EMB_BATCH, count - first));
            arguments.P = out;
            arguments.dPdu = out + 3 * arguments.N;
            arguments.dPdv = out + 6 * arguments.N;
            rtcInterpolateN(&arguments);
        }
        subdivision->check();
    });
}

osd_status emb_triangles_create(int32_t point_count, const float *points, int32_t triangle_count,
                                const uint32_t *indices, int32_t threads, emb_triangles **out) {
    return create(out, [&] {
        auto made = std::make_unique<emb_triangles>(threads);
        made->geometry = rtcNewGeometry(made->device, RTC_GEOMETRY_TYPE_TRIANGLE);
        made->copy(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, 3, points, std::size_t(point_count));
        made->copy(RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, 3, indices, std::size_t(triangle_count));
        made->commit();
        return made;
    });
}

void emb_triangles_destroy(emb_triangles *triangles) { delete triangles; }

osd_status emb_triangles_trace(const emb_triangles *triangles, const emb_camera *camera, int32_t threads,
                               float *depths, int64_t *hits) {
    return guard([&] {
        constexpr int32_t TILE = 16; // rays of a tile are neighbours
        int32_t const columns = (camera->width + TILE - 1) / TILE, rows = (camera->height + TILE - 1) / TILE;
        std::atomic<int32_t> next{0};
        std::atomic<int64_t> met{0};
        auto const work = [&] {
            FlushToZero const flush;
            Query query;
            int64_t own = 0;
            for (int32_t tile; (tile = next++) < columns * rows;) {
                int32_t const x0 = tile % columns * TILE, y0 = tile / columns * TILE;
                for (int32_t y = y0; y < std::min(y0 + TILE, camera->height); y += SIDE)
                    for (int32_t x = x0; x < std::min(x0 + TILE, camera->width); x += SIDE)
                        own += trace_packet(triangles->scene, query, *camera, x, y, depths);
            }
            met += own;
        };
        std::vector<std::thread> others;
        for (int32_t i = 1; i < threads; ++i) others.emplace_back(work);
        work();
        for (std::thread &other : others) other.join();
        *hits = met;
        triangles->check();
    });
}

} // extern "C"
