// The main reference: osd_stencils_* (Far::LimitStencilTable).
#include "guard.hpp"
#include "table.hpp"

#include <opensubdiv/far/patchMap.h>
#include <opensubdiv/far/stencilTableFactory.h>

#include <algorithm>

using namespace catoptric;

struct osd_stencils {
    std::unique_ptr<Far::TopologyRefiner> base; // never refined: each call refines a copy that shares its level
    std::vector<int> face_of_ptex;
    int isolation;
};

namespace {

using Table = Far::LimitStencilTableReal<double>;
using Factory = Far::LimitStencilTableFactoryReal<double>;

// Stencils of samples, and what answers each.
struct Answers {
    std::unique_ptr<Table const> table;
    std::vector<uint8_t> answers; // an osd_answer each; those that are not OSD_ANSWER_NONE have a stencil, in order
    std::vector<double> cells, scales;
};

void sort_unique(std::vector<int> &faces) {
    std::sort(faces.begin(), faces.end());
    faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
}

std::vector<int> control_faces(osd_stencils const &handle, int32_t count, int32_t const *faces) {
    std::vector<int> selected;
    for (int32_t i = 0; i < count; ++i) {
        require(faces[i] >= 0 && faces[i] < int32_t(handle.face_of_ptex.size()), "ptex face out of range");
        selected.push_back(handle.face_of_ptex[faces[i]]);
    }
    sort_unique(selected);
    return selected;
}

// The faces and all that share a vertex with them. Where refinement ends, 3.5.0 averages Chaikin's sharpness over the edges
// that are there, so the faces at the end get wrong creases (by 3e-6 of the diagonal on a test mesh). The error creeps
// inwards by an edge a level, 1/2 + 1/4 + ... of a face: less than the ring.
std::vector<int> with_ring(Far::TopologyRefiner const &base, std::vector<int> const &faces) {
    Far::TopologyLevel const level = base.GetLevel(0);
    std::vector<int> ring(faces);
    for (int face : faces)
        for (int vertex : level.GetFaceVertices(face)) {
            auto const around = level.GetVertexFaces(vertex);
            ring.insert(ring.end(), around.begin(), around.end());
        }
    sort_unique(ring);
    return ring;
}

// Refines round the faces that the samples lie in, and makes a stencil for each sample that has a surface.
Answers answer(osd_stencils const &handle, int32_t count, int32_t const *faces, double const *uv) {
    using Bases = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    Answers out;
    if (count == 0) return out;
    std::vector<int> const selected = control_faces(handle, count, faces);
    Far::ConstIndexArray const selection(selected.data(), int(selected.size()));
    std::unique_ptr<Far::TopologyRefiner> refiner(Bases::Create(*handle.base));
    Far::PatchTableFactory::Options const options = exact_options(handle.isolation);
    std::vector<int> const refined = with_ring(*handle.base, selected);
    refiner->RefineAdaptive(options.GetRefineAdaptiveOptions(), {refined.data(), int(refined.size())});
    count_points(*refiner);
    // Ours, because the stencil factory's own keeps the defaults that move smooth corners.
    std::unique_ptr<Far::PatchTable> const patches(Far::PatchTableFactory::Create(*refiner, options, selection));
    if (!patches) throw std::runtime_error("OpenSubdiv made no patch table");
    Far::PatchMap const map(*patches);

    // The factory leaves out samples without a surface in silence, so they are sorted out before.
    std::vector<double> u, v;
    std::vector<int> ptex;
    for (int32_t i = 0; i < count; ++i) {
        double const at[2] = {flushed(uv[2 * i]), flushed(uv[2 * i + 1])};
        Far::PatchTable::PatchHandle const *found = map.FindPatch(faces[i], at[0], at[1]);
        out.answers.push_back(!found                        ? OSD_ANSWER_NONE
                              : is_regular(*patches, *found) ? OSD_ANSWER_REGULAR
                                                             : OSD_ANSWER_END_CAP);
        if (!found) continue;
        Far::PatchParam const param = patches->GetPatchParam(*found);
        out.cells.push_back(param.GetParamFraction());
        out.scales.push_back(derivative_scale(param));
        u.push_back(at[0]), v.push_back(at[1]), ptex.push_back(faces[i]);
    }
    if (ptex.empty()) return out;
    Factory::LocationArrayVec locations;
    for (std::size_t i = 0; i < ptex.size(); ++i) {
        if (locations.empty() || locations.back().ptexIdx != ptex[i]) {
            locations.emplace_back();
            locations.back().ptexIdx = ptex[i];
            locations.back().s = &u[i], locations.back().t = &v[i];
        }
        ++locations.back().numLocations;
    }
    out.table.reset(Factory::Create(*refiner, locations, nullptr, patches.get()));
    if (!out.table || out.table->GetNumStencils() != int(ptex.size()))
        throw std::runtime_error("OpenSubdiv made another number of limit stencils than it has samples");
    return out;
}

} // namespace

extern "C" {

osd_status osd_stencils_create(const osd_mesh *mesh, int32_t isolation, osd_stencils **out) {
    return create(out, [&] {
        require(isolation >= 1 && isolation <= 10, "isolation must be 1 to 10");
        auto handle = std::make_unique<osd_stencils>();
        handle->base = make_refiner(*mesh);
        handle->isolation = isolation;
        for (int face = 0; face < mesh->face_count; ++face) {
            handle->face_of_ptex.insert(handle->face_of_ptex.end(), ptex_faces(*mesh, mesh->face_sizes[face]), face);
        }
        return handle;
    });
}

void osd_stencils_destroy(osd_stencils *handle) { delete handle; }

osd_status osd_stencils_evaluate(const osd_stencils *handle, const double *points, int32_t count, const int32_t *faces,
                                 const double *uv, double *jets, double *cells, uint8_t *answers, int32_t *terms) {
    return guard([&] {
        Answers const found = answer(*handle, count, faces, uv);
        std::vector<Point> control(handle->base->GetLevel(0).GetNumVertices());
        std::memcpy(control.data(), points, control.size() * sizeof(Point));
        std::vector<Point> position(found.cells.size()), du(position), dv(position);
        if (found.table) {
            found.table->UpdateValues(control.data(), position.data());
            found.table->UpdateDerivs(control.data(), du.data(), dv.data());
        }
        std::fill_n(jets, 9 * std::size_t(count), 0.0);
        int stencil = 0;
        for (int32_t i = 0; i < count; ++i, jets += 9) {
            answers[i] = found.answers[i];
            cells[i] = 1.0;
            terms[i] = 0;
            if (answers[i] == OSD_ANSWER_NONE) continue;
            for (int k = 0; k < 3; ++k) {
                jets[k] = position[stencil].x[k];
                jets[3 + k] = found.scales[stencil] * du[stencil].x[k];
                jets[6 + k] = found.scales[stencil] * dv[stencil].x[k];
            }
            cells[i] = found.cells[stencil];
            terms[i] = found.table->GetSizes()[stencil];
            ++stencil;
        }
    });
}

osd_status osd_stencils_weights(const osd_stencils *handle, int32_t face, const double *uv, int32_t capacity,
                                int32_t *size, int32_t *vertices, double *weights, uint8_t *kind) {
    return guard([&] {
        Answers const found = answer(*handle, 1, &face, uv);
        *kind = found.answers[0];
        *size = found.table ? found.table->GetSizes()[0] : 0;
        for (int i = 0; i < std::min(*size, capacity); ++i) {
            vertices[i] = found.table->GetControlIndices()[i];
            weights[3 * i] = found.table->GetWeights()[i];
            weights[3 * i + 1] = found.scales[0] * found.table->GetDuWeights()[i];
            weights[3 * i + 2] = found.scales[0] * found.table->GetDvWeights()[i];
        }
    });
}

} // extern "C"
