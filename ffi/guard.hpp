// What every C entry shares: the guard, and the mesh handed to OpenSubdiv.
#pragma once

#include "osd.h"

#include <opensubdiv/far/error.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefiner.h>
#include <opensubdiv/version.h>

#include <cstring>
#include <exception>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

static_assert(OPENSUBDIV_VERSION_NUMBER == 30500,
              "catoptric is written for and checked against OpenSubdiv 3.5.0 (Debian 12: libosd-dev)");

namespace catoptric {

namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

// Message of the last failure on this thread.
std::string &message();
// Installs OpenSubdiv's global callbacks, once.
void install_callbacks();
std::unique_ptr<Far::TopologyRefiner> make_refiner(osd_mesh const &mesh);

// A point as PrimvarRefiner and stencils want it: cleared, then a weighted sum.
struct Point {
    double x[3];
    void Clear() { x[0] = x[1] = x[2] = 0; }
    void AddWithWeight(Point const &point, double weight) {
        for (int i = 0; i < 3; ++i) x[i] += weight * point.x[i];
    }
};
static_assert(sizeof(Point) == 3 * sizeof(double), "points are packed triples");

// Refined points of all levels, one level after the other, level 0 (a copy of points) first.
void interpolate(Far::TopologyRefiner const &refiner, double const *points, Point *out);

// Runs body; an exception, or anything that OpenSubdiv reports as an error, becomes OSD_FAILED and a message.
template <class Body> osd_status guard(Body &&body) noexcept {
    try {
        install_callbacks();
        message().clear();
        body();
    } catch (std::exception const &error) {
        message() = error.what();
    } catch (...) {
        message() = "unknown C++ exception";
    }
    return message().empty() ? OSD_OK : OSD_FAILED;
}

inline void require(bool condition, char const *what) {
    if (!condition) throw std::invalid_argument(what);
}

} // namespace catoptric
