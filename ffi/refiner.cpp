// Topology refinement: osd_refiner_*.
#include "guard.hpp"

#include <opensubdiv/far/primvarRefiner.h>

#include <algorithm>

namespace catoptric {

Outcome &outcome() noexcept {
    thread_local Outcome outcome;
    return outcome;
}

void install_callbacks() {
    static std::once_flag once;
    std::call_once(once, [] {
        // The callbacks take no user data, so the message goes to the thread that made the call.
        Far::SetErrorCallback([](Far::ErrorType, char const *text) { outcome().fail(text); });
        Far::SetWarningCallback([](char const *) {});
    });
}

static Sdc::SchemeType to_sdc(osd_scheme scheme) {
    switch (scheme) {
    case OSD_SCHEME_CATMULL_CLARK: return Sdc::SCHEME_CATMARK;
    case OSD_SCHEME_LOOP: return Sdc::SCHEME_LOOP;
    case OSD_SCHEME_BILINEAR: return Sdc::SCHEME_BILINEAR;
    }
    throw std::invalid_argument("unknown scheme");
}

std::unique_ptr<Far::TopologyRefiner> make_refiner(osd_mesh const &mesh) {
    Sdc::Options rules;
    switch (mesh.boundary) {
    case OSD_BOUNDARY_NONE: rules.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_NONE); break;
    case OSD_BOUNDARY_EDGE_ONLY: rules.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_ONLY); break;
    case OSD_BOUNDARY_EDGE_AND_CORNER:
        rules.SetVtxBoundaryInterpolation(Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
        break;
    }
    switch (mesh.creasing) {
    case OSD_CREASING_UNIFORM: rules.SetCreasingMethod(Sdc::Options::CREASE_UNIFORM); break;
    case OSD_CREASING_CHAIKIN: rules.SetCreasingMethod(Sdc::Options::CREASE_CHAIKIN); break;
    }
    switch (mesh.triangles) {
    case OSD_TRIANGLES_CATMULL_CLARK: rules.SetTriangleSubdivision(Sdc::Options::TRI_SUB_CATMARK); break;
    case OSD_TRIANGLES_SMOOTH: rules.SetTriangleSubdivision(Sdc::Options::TRI_SUB_SMOOTH); break;
    }

    Far::TopologyDescriptor topology;
    topology.numVertices = mesh.vertex_count;
    topology.numFaces = mesh.face_count;
    topology.numVertsPerFace = mesh.face_sizes;
    topology.vertIndicesPerFace = mesh.face_vertices;
    topology.numCreases = mesh.crease_count;
    topology.creaseVertexIndexPairs = mesh.crease_vertices;
    topology.creaseWeights = mesh.crease_sharpness;
    topology.numCorners = mesh.corner_count;
    topology.cornerVertexIndices = mesh.corner_vertices;
    topology.cornerWeights = mesh.corner_sharpness;
    topology.numHoles = mesh.hole_count;
    topology.holeIndices = mesh.holes;

    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    std::unique_ptr<Far::TopologyRefiner> refiner(
        Factory::Create(topology, Factory::Options(to_sdc(mesh.scheme), rules)));
    if (!refiner)
        throw std::runtime_error(outcome().failed ? outcome().message
                                                  : "OpenSubdiv refused the topology without a reason");
    return refiner;
}

std::size_t count_points(Far::TopologyRefiner const &refiner, int64_t more) {
    int64_t count = more;
    for (int i = 0; i < refiner.GetNumLevels(); ++i) count += refiner.GetLevel(i).GetNumVertices();
    require(more >= 0 && count <= INT32_MAX, "the refined mesh has more points than 32-bit indices can count");
    return std::size_t(count);
}

void interpolate(Far::TopologyRefiner const &refiner, double const *points, Point *out) {
    std::memcpy(out, points, sizeof(Point) * refiner.GetLevel(0).GetNumVertices());
    Far::PrimvarRefinerReal<double> const primvar(refiner);
    for (int i = 1; i < refiner.GetNumLevels(); ++i) {
        Point *next = out + refiner.GetLevel(i - 1).GetNumVertices();
        primvar.Interpolate(i, out, next);
        out = next;
    }
}

} // namespace catoptric

using namespace catoptric;

struct osd_refiner {
    std::unique_ptr<Far::TopologyRefiner> refiner;
};

namespace {

Far::TopologyLevel level_at(osd_refiner const *handle, int32_t level) {
    require(level >= 0 && level < handle->refiner->GetNumLevels(), "level out of range");
    return handle->refiner->GetLevel(level);
}

uint8_t rule_of(Sdc::Crease::Rule rule) {
    switch (rule) {
    case Sdc::Crease::RULE_SMOOTH: return OSD_RULE_SMOOTH;
    case Sdc::Crease::RULE_DART: return OSD_RULE_DART;
    case Sdc::Crease::RULE_CREASE: return OSD_RULE_CREASE;
    case Sdc::Crease::RULE_CORNER: return OSD_RULE_CORNER;
    default: return OSD_RULE_UNKNOWN;
    }
}

// Vertices that PrimvarRefiner::Limit has no room for: its arrays hold a vertex and twice as many others as the level's valence,
// at least 33 in all. Neighbours across edges and faces share them, and only a vertex that is not manifold has more faces than
// edges. It takes no account of that (3.5.0 to 3.6.0): from 11 faces at an edge on, it writes beyond them.
int32_t count_crowded(Far::TopologyLevel const &level) {
    int valence = 0;
    for (int v = 0; v < level.GetNumVertices(); ++v) valence = std::max(valence, level.GetVertexEdges(v).size());
    // Weights of three masks lie one after the other, those of faces behind those of `valence` edges.
    int const indices = std::max(33, 1 + 2 * valence), weights = std::max(99, 3 * (1 + 2 * valence));
    int32_t crowded = 0;
    for (int v = 0; v < level.GetNumVertices(); ++v) {
        int const edges = level.GetVertexEdges(v).size(), faces = level.GetVertexFaces(v).size();
        crowded += edges + faces > indices || 2 * (1 + 2 * valence) + 1 + valence + faces > weights;
    }
    return crowded;
}

} // namespace

extern "C" {

const char *osd_message(void) {
    bool const lost = outcome().failed && outcome().message.empty();
    return lost ? "it failed without a message" : outcome().message.c_str();
}

const char *osd_version(void) {
    // 3.5.0 is 30500. Short enough to need no allocation, so this cannot throw.
    static std::string const text = std::to_string(OPENSUBDIV_VERSION_NUMBER / 10000) + "." +
                                    std::to_string(OPENSUBDIV_VERSION_NUMBER / 100 % 100) + "." +
                                    std::to_string(OPENSUBDIV_VERSION_NUMBER % 100);
    return text.c_str();
}

osd_status osd_refiner_create(const osd_mesh *mesh, osd_refiner **out) {
    return create(out, [&] {
        auto refiner = std::make_unique<osd_refiner>();
        refiner->refiner = make_refiner(*mesh);
        return refiner;
    });
}

void osd_refiner_destroy(osd_refiner *refiner) { delete refiner; }

osd_status osd_refiner_refine_adaptive(osd_refiner *handle, int32_t isolation, int32_t secondary,
                                       int32_t single_crease) {
    return guard([&] {
        require(isolation >= 1 && isolation <= 10, "isolation must be 1 to 10");
        require(secondary >= 0 && secondary <= 10, "secondary isolation must be 0 to 10");
        require(handle->refiner->GetMaxLevel() == 0, "the mesh is refined already");
        Far::TopologyRefiner::AdaptiveOptions options(isolation);
        options.SetSecondaryLevel(secondary);
        options.useInfSharpPatch = true;
        options.useSingleCreasePatch = single_crease != 0;
        handle->refiner->RefineAdaptive(options);
        count_points(*handle->refiner);
    });
}

osd_status osd_refiner_refine_uniform(osd_refiner *handle, int32_t level) {
    return guard([&] {
        require(level >= 1 && level <= 10, "the refinement level must be 1 to 10");
        require(handle->refiner->GetMaxLevel() == 0, "the mesh is refined already");
        Far::TopologyRefiner::UniformOptions options(level);
        options.fullTopologyInLastLevel = true;
        handle->refiner->RefineUniform(options);
        count_points(*handle->refiner);
    });
}

osd_status osd_refiner_level_count(const osd_refiner *handle, int32_t *out) {
    return guard([&] { *out = handle->refiner->GetNumLevels(); });
}

osd_status osd_refiner_level_sizes(const osd_refiner *handle, int32_t level, osd_level_sizes *out) {
    return guard([&] {
        Far::TopologyLevel const topology = level_at(handle, level);
        *out = {topology.GetNumVertices(), topology.GetNumEdges(), topology.GetNumFaces(),
                topology.GetNumFaceVertices()};
    });
}

osd_status osd_refiner_level(const osd_refiner *handle, int32_t level, const osd_level_arrays *out) {
    return guard([&] {
        Far::TopologyLevel const topology = level_at(handle, level);
        bool const has_children = level + 1 < handle->refiner->GetNumLevels();
        int32_t offset = 0;
        for (int f = 0; f < topology.GetNumFaces(); ++f) {
            auto const vertices = topology.GetFaceVertices(f);
            auto const edges = topology.GetFaceEdges(f);
            out->face_offsets[f] = offset;
            out->face_holes[f] = topology.IsFaceHole(f);
            std::copy(vertices.begin(), vertices.end(), out->face_vertices + offset);
            std::copy(edges.begin(), edges.end(), out->face_edges + offset);
            std::fill_n(out->face_children + offset, vertices.size(), -1);
            out->face_middles[f] = -1;
            if (has_children) {
                // A triangle under Loop's scheme has one more, the last.
                auto const children = topology.GetFaceChildFaces(f);
                std::copy_n(children.begin(), vertices.size(), out->face_children + offset);
                if (children.size() > vertices.size()) out->face_middles[f] = children[vertices.size()];
            }
            offset += vertices.size();
        }
        out->face_offsets[topology.GetNumFaces()] = offset;
        for (int e = 0; e < topology.GetNumEdges(); ++e) {
            auto const faces = topology.GetEdgeFaces(e);
            bool const manifold = !topology.IsEdgeNonManifold(e) && faces.size() <= 2;
            out->edge_faces[2 * e] = !manifold ? -2 : faces.size() > 0 ? faces[0] : -1;
            out->edge_faces[2 * e + 1] = !manifold ? -2 : faces.size() > 1 ? faces[1] : -1;
            out->edge_sharpness[e] = topology.GetEdgeSharpness(e);
        }
        for (int v = 0; v < topology.GetNumVertices(); ++v) {
            out->vertex_sharpness[v] = topology.GetVertexSharpness(v);
            out->vertex_rules[v] = rule_of(topology.GetVertexRule(v));
            out->vertex_children[v] = has_children ? topology.GetVertexChildVertex(v) : -1;
        }
    });
}

osd_status osd_refiner_interpolate(const osd_refiner *handle, const double *points, double *out) {
    return guard([&] { interpolate(*handle->refiner, points, reinterpret_cast<Point *>(out)); });
}

osd_status osd_refiner_limit(const osd_refiner *handle, const double *points, double *positions, double *tangents_1,
                             double *tangents_2, int32_t *crowded) {
    return guard([&] {
        require(handle->refiner->IsUniform(), "limit masks need uniform refinement");
        *crowded = count_crowded(handle->refiner->GetLevel(handle->refiner->GetMaxLevel()));
        if (*crowded > 0) return;
        Far::PrimvarRefinerReal<double> const primvar(*handle->refiner);
        Point const *source = reinterpret_cast<Point const *>(points);
        Point *limit = reinterpret_cast<Point *>(positions);
        Point *first = reinterpret_cast<Point *>(tangents_1), *second = reinterpret_cast<Point *>(tangents_2);
        primvar.Limit(source, limit, first, second);
    });
}

} // extern "C"
