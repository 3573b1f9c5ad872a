// What every C entry shares: the guard, and the mesh handed to OpenSubdiv.
#pragma once

#include "osd.h"

#include <opensubdiv/far/error.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefiner.h>
#include <opensubdiv/version.h>

#include <cstdint>
#include <cstring>
#include <exception>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

static_assert(OPENSUBDIV_VERSION_NUMBER >= 30500 && OPENSUBDIV_VERSION_NUMBER < 40000,
              "catoptric is checked against OpenSubdiv 3.5.0 (Debian 12) and 3.6.0 (Debian 13: libosd-dev); another major "
              "version has another interface");

namespace catoptric {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

// How the call in progress on this thread went.
struct Outcome {
    bool failed = false;
    std::string message;

    void clear() noexcept {
        failed = false;
        message.clear();
    }
    // Callable from OpenSubdiv's callbacks and from handlers, so it must not throw: without memory the text is lost, the
    // failure is not.
    void fail(char const *text) noexcept {
        failed = true;
        try {
            message = text;
        } catch (...) {
            message.clear();
        }
    }
};
Outcome &outcome() noexcept;
// Installs OpenSubdiv's global callbacks, once.
void install_callbacks();
std::unique_ptr<Far::TopologyRefiner> make_refiner(osd_mesh const &mesh);

// Ptex faces that a control face of `size` corners takes.
inline int ptex_faces(osd_mesh const &mesh, int size) {
    return size == (mesh.scheme == OSD_SCHEME_LOOP ? 3 : 4) ? 1 : size;
}

// A point as PrimvarRefiner and stencils want it: cleared, then a weighted sum.
struct Point {
    double x[3];
    void Clear() { x[0] = x[1] = x[2] = 0; }
    void AddWithWeight(Point const &point, double weight) {
        for (int i = 0; i < 3; ++i) x[i] += weight * point.x[i];
    }
};
static_assert(sizeof(Point) == 3 * sizeof(double), "points are packed triples");

// Vertices of all levels, and `more`: an error where OpenSubdiv's 32-bit indices cannot count them.
std::size_t count_points(Far::TopologyRefiner const &refiner, int64_t more = 0);

// Refined points of all levels, one level after the other, level 0 (a copy of points) first.
void interpolate(Far::TopologyRefiner const &refiner, double const *points, Point *out);

// Runs body; an exception, or anything that OpenSubdiv reports as an error, becomes OSD_FAILED and a message.
template <class Body> osd_status guard(Body &&body) noexcept {
    outcome().clear();
    try {
        install_callbacks();
        body();
    } catch (std::exception const &error) {
        outcome().fail(error.what());
    } catch (...) {
        outcome().fail("unknown C++ exception");
    }
    return outcome().failed ? OSD_FAILED : OSD_OK;
}

// Hands out what make returns, a unique_ptr, unless the call failed: OpenSubdiv may report an error and return an object
// all the same, which is released here then.
template <class Object, class Make> osd_status create(Object **out, Make &&make) noexcept {
    std::unique_ptr<Object> object;
    osd_status const status = guard([&] { object = make(); });
    if (status == OSD_OK) *out = object.release();
    return status;
}

inline void require(bool condition, char const *what) {
    if (!condition) throw std::invalid_argument(what);
}

} // namespace catoptric
