// The reference evaluators: osd_far_* (Far::PatchTable) and osd_bfr_* (Bfr surfaces).
#include "bfr.hpp"
#include "guard.hpp"
#include "table.hpp"

#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/far/patchMap.h>
#include <opensubdiv/far/patchTable.h>

#include <algorithm>

using namespace catoptric;
namespace Bfr = OpenSubdiv::Bfr;

struct osd_far {
    std::unique_ptr<Far::PatchTable> table;
    std::unique_ptr<Far::PatchMap> map;
    std::vector<Point> points; // refined, then local: only end caps have these
    std::size_t refined = 0;
    bool bilinear_caps = false; // end caps without points of their own

    bool is_end_cap(Far::ConstIndexArray vertices) const {
        if (bilinear_caps && vertices.size() < 5) return true;
        return std::any_of(vertices.begin(), vertices.end(), [&](Far::Index i) { return std::size_t(i) >= refined; });
    }
};

static Far::PatchTableFactory::Options::EndCapType to_far(osd_end_cap end_cap) {
    switch (end_cap) {
    case OSD_END_CAP_GREGORY: return Far::PatchTableFactory::Options::ENDCAP_GREGORY_BASIS;
    case OSD_END_CAP_BSPLINE: return Far::PatchTableFactory::Options::ENDCAP_BSPLINE_BASIS;
    case OSD_END_CAP_BILINEAR: return Far::PatchTableFactory::Options::ENDCAP_BILINEAR_BASIS;
    }
    throw std::invalid_argument("unknown end cap");
}

struct osd_bfr {
    using Factory = Bfr::RefinerSurfaceFactory<>;
    std::unique_ptr<Far::TopologyRefiner> refiner;
    std::unique_ptr<Factory> factory;
    std::vector<double> mesh_points;
    std::vector<Ptex> ptex;

    // The surface of the last face asked for: samples come grouped by face.
    int face = -1;
    Bfr::Surface<double> surface;
    std::vector<double> patch_points;
};

extern "C" {

osd_status osd_far_create(const osd_mesh *mesh, const double *points, int32_t isolation, int32_t secondary,
                          osd_end_cap end_cap, int32_t library_options, osd_far **out) {
    return create(out, [&] {
        require(isolation >= 1 && isolation <= 10, "isolation must be 1 to 10");
        require(secondary >= 1 && secondary <= isolation, "secondary isolation must be 1 to that of sharp features");
        auto refiner = make_refiner(*mesh);

        Far::PatchTableFactory::Options options = exact_options(isolation);
        options.SetEndCapType(to_far(end_cap));
        options.useInfSharpPatch = !(library_options & OSD_FAR_SMOOTHED_CREASES);
        options.generateLegacySharpCornerPatches = bool(library_options & OSD_FAR_LEGACY_CORNERS);
        options.useSingleCreasePatch = bool(library_options & OSD_FAR_SINGLE_CREASE);
        Far::TopologyRefiner::AdaptiveOptions refinement = options.GetRefineAdaptiveOptions();
        refinement.SetSecondaryLevel(secondary);
        refiner->RefineAdaptive(refinement);

        auto far = std::make_unique<osd_far>();
        far->bilinear_caps = end_cap == OSD_END_CAP_BILINEAR && mesh->scheme != OSD_SCHEME_BILINEAR;
        far->table.reset(Far::PatchTableFactory::Create(*refiner, options));
        if (!far->table) throw std::runtime_error("OpenSubdiv made no patch table");
        far->map = std::make_unique<Far::PatchMap>(*far->table);

        std::size_t const refined = far->refined = count_points(*refiner);
        far->points.resize(count_points(*refiner, far->table->GetNumLocalPoints()));
        interpolate(*refiner, points, far->points.data());
        if (far->table->GetNumLocalPoints() > 0) {
            Point const *source = far->points.data();
            Point *local = far->points.data() + refined;
            far->table->GetLocalPointStencilTable<double>()->UpdateValues(source, local);
        }
        return far;
    });
}

void osd_far_destroy(osd_far *far) { delete far; }

osd_status osd_far_measure(const osd_far *far, osd_far_sizes *out) {
    return guard([&] {
        out->patches = far->table->GetNumPatchesTotal();
        out->control_points = int64_t(far->table->GetPatchControlVerticesTable().size());
        out->bytes = int64_t(far->table->GetPatchControlVerticesTable().size() * sizeof(Far::Index) +
                             far->table->GetPatchParamTable().size() * sizeof(Far::PatchParam) +
                             far->points.size() * sizeof(Point));
    });
}

osd_status osd_far_patches(const osd_far *far, osd_far_patch *patches, double *points) {
    return guard([&] {
        Far::PatchTable const &table = *far->table;
        for (int array = 0; array < table.GetNumPatchArrays(); ++array) {
            for (int i = 0; i < table.GetNumPatches(array); ++i, ++patches) {
                auto const vertices = table.GetPatchVertices(array, i);
                Far::PatchParam const param = table.GetPatchParam(array, i);
                double const side = param.GetParamFraction();
                *patches = osd_far_patch{};
                patches->face = param.GetFaceId();
                patches->origin[0] = side * param.GetU();
                patches->origin[1] = side * param.GetV();
                patches->points = vertices.size();
                // The quadrants of an n-gon are faces of level 1, and ptex faces of their own.
                patches->level = uint8_t(param.GetDepth());
                patches->depth = uint8_t(param.GetDepth() - (param.NonQuadRoot() ? 1 : 0));
                patches->boundary = uint8_t(param.GetBoundary());
                patches->transition = uint8_t(param.GetTransition());
                patches->end_cap = far->is_end_cap(vertices);
                for (Far::Index vertex : vertices) {
                    std::copy_n(far->points[vertex].x, 3, points);
                    points += 3;
                }
            }
        }
    });
}

osd_status osd_far_evaluate(const osd_far *far, int32_t count, const int32_t *faces, const double *uv, double *jets,
                            double *cells, uint8_t *answers) {
    return guard([&] {
        // The most points that a patch has: 20 of a Gregory patch.
        double p[20], du[20], dv[20];
        for (int32_t i = 0; i < count; ++i, jets += 9) {
            std::fill_n(jets, 9, 0.0);
            cells[i] = 1.0;
            double const u = flushed(uv[2 * i]), v = flushed(uv[2 * i + 1]);
            Far::PatchTable::PatchHandle const *handle = far->map->FindPatch(faces[i], u, v);
            if (!handle) {
                answers[i] = OSD_ANSWER_NONE;
                continue;
            }
            auto const vertices = far->table->GetPatchVertices(*handle);
            require(vertices.size() <= 20, "a patch of more than 20 points");
            far->table->EvaluateBasis<double>(*handle, u, v, p, du, dv);
            Far::PatchParam const param = far->table->GetPatchParam(*handle);
            double const scale = derivative_scale(param);
            cells[i] = param.GetParamFraction();
            for (int j = 0; j < vertices.size(); ++j)
                for (int k = 0; k < 3; ++k) {
                    double const x = far->points[vertices[j]].x[k];
                    jets[k] += p[j] * x;
                    jets[3 + k] += scale * du[j] * x;
                    jets[6 + k] += scale * dv[j] * x;
                }
            answers[i] = far->is_end_cap(vertices) ? OSD_ANSWER_END_CAP : OSD_ANSWER_REGULAR;
        }
    });
}

osd_status osd_bfr_create(const osd_mesh *mesh, const double *points, int32_t smooth_level, int32_t sharp_level,
                          osd_bfr **out) {
    return create(out, [&] {
        require(smooth_level >= 1 && smooth_level <= 10 && sharp_level >= 1 && sharp_level <= 10,
                "approximation levels must be 1 to 10");
        auto bfr = std::make_unique<osd_bfr>();
        bfr->refiner = make_refiner(*mesh);
        osd_bfr::Factory::Options options;
        options.SetApproxLevelSmooth(smooth_level);
        options.SetApproxLevelSharp(sharp_level);
        bfr->factory = std::make_unique<osd_bfr::Factory>(*bfr->refiner, options);
        bfr->mesh_points.assign(points, points + 3 * mesh->vertex_count);
        bfr->ptex = list_ptex(*mesh);
        return bfr;
    });
}

void osd_bfr_destroy(osd_bfr *bfr) { delete bfr; }

osd_status osd_bfr_evaluate(osd_bfr *bfr, int32_t count, const int32_t *faces, const double *uv, double *jets,
                            double *cells, uint8_t *answers) {
    return guard([&] {
        for (int32_t i = 0; i < count; ++i, jets += 9) {
            std::fill_n(jets, 9, 0.0);
            cells[i] = 1.0;
            require(faces[i] >= 0 && faces[i] < int32_t(bfr->ptex.size()), "ptex face out of range");
            Ptex const ptex = bfr->ptex[faces[i]];
            if (!is_safe(*bfr->refiner, ptex.face)) {
                answers[i] = OSD_ANSWER_NOT_ASKED;
                continue;
            }
            if (ptex.face != bfr->face) {
                bfr->face = -1; // until the surface is whole: what follows may throw
                if (!bfr->factory->InitVertexSurface(ptex.face, &bfr->surface)) bfr->surface.Clear();
                if (bfr->surface.IsValid()) {
                    bfr->patch_points.resize(3 * bfr->surface.GetNumPatchPoints());
                    bfr->surface.PreparePatchPoints(bfr->mesh_points.data(), 3, bfr->patch_points.data(), 3);
                }
                bfr->face = ptex.face;
            }
            if (!bfr->surface.IsValid()) {
                answers[i] = OSD_ANSWER_NONE;
                continue;
            }
            double coordinate[2] = {flushed(uv[2 * i]), flushed(uv[2 * i + 1])};
            double scale = 1.0;
            if (ptex.sub_face >= 0) {
                double const sub[2] = {coordinate[0], coordinate[1]};
                bfr->surface.GetParameterization().ConvertNormalizedSubFaceToCoord(ptex.sub_face, sub, coordinate);
                scale = 0.5; // a sub-face spans half a unit of the face's parameters
            }
            bfr->surface.Evaluate(coordinate, bfr->patch_points.data(), 3, jets, jets + 3, jets + 6);
            for (int k = 3; k < 9; ++k) jets[k] *= scale;
            bool const exact = bfr->surface.IsRegular() || bfr->surface.IsLinear();
            answers[i] = exact ? OSD_ANSWER_REGULAR : OSD_ANSWER_END_CAP;
        }
    });
}

} // extern "C"
