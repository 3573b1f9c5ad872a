// Peers of benchmarks: Bfr and Osd as their documentation recommends them, with loops on this side of the interface.
#include "bfr.hpp"
#include "guard.hpp"
#include "table.hpp"

#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/far/patchMap.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/osd/cpuEvaluator.h>
#include <opensubdiv/osd/cpuPatchTable.h>

using namespace catoptric;
namespace Bfr = OpenSubdiv::Bfr;
namespace Osd = OpenSubdiv::Osd;

namespace {

template <class Real> struct Surfaces {
    struct One {
        Bfr::Surface<Real> surface;
        std::vector<Real> points;
    };
    std::vector<One> faces;

    void make(Bfr::RefinerSurfaceFactory<> const &factory, Far::TopologyRefiner const &refiner,
              std::vector<Real> const &points) {
        faces.resize(std::size_t(refiner.GetLevel(0).GetNumFaces()));
        for (std::size_t face = 0; face < faces.size(); ++face) {
            One &one = faces[face];
            if (!is_safe(refiner, int(face)) || !factory.InitVertexSurface(int(face), &one.surface)) continue;
            one.points.resize(3 * std::size_t(one.surface.GetNumPatchPoints()));
            one.surface.PreparePatchPoints(points.data(), 3, one.points.data(), 3);
        }
    }

    void evaluate(std::vector<Ptex> const &ptex, int32_t count, int32_t const *at, Real const *uv, Real *jets) const {
        for (int32_t i = 0; i < count; ++i, jets += 9) {
            Ptex const place = ptex[std::size_t(at[i])];
            One const &one = faces[std::size_t(place.face)];
            if (one.points.empty()) {
                std::fill_n(jets, 9, Real(0));
                continue;
            }
            Real coordinate[2] = {uv[2 * i], uv[2 * i + 1]};
            Real scale = 1;
            if (place.sub_face >= 0) {
                Real const sub[2] = {coordinate[0], coordinate[1]};
                one.surface.GetParameterization().ConvertNormalizedSubFaceToCoord(place.sub_face, sub, coordinate);
                scale = Real(0.5); // a sub-face spans half a unit of the face's parameters
            }
            one.surface.Evaluate(coordinate, one.points.data(), 3, jets, jets + 3, jets + 6);
            if (scale != 1)
                for (int k = 3; k < 9; ++k) jets[k] *= scale;
        }
    }
};

} // namespace

struct osd_bfr_peer {
    std::unique_ptr<Far::TopologyRefiner> refiner;
    std::unique_ptr<Bfr::RefinerSurfaceFactory<>> factory;
    std::vector<Ptex> ptex;
    bool in_double = false;
    Surfaces<float> singles;
    Surfaces<double> doubles;
};

struct osd_cpu {
    std::unique_ptr<Far::PatchTable> table;
    std::unique_ptr<Far::PatchMap> map;
    std::unique_ptr<Far::StencilTable const> stencils;
    std::unique_ptr<Osd::CpuPatchTable> cpu_table;
    std::vector<float> points; // control, refined, local
    std::size_t control = 0;
    std::vector<Osd::PatchCoord> coordinates;

    void update(float const *control_points) {
        std::copy_n(control_points, 3 * control, points.data());
        Osd::BufferDescriptor const source(0, 3, 3), target(int(3 * control), 3, 3);
        Far::StencilTable const &table = *stencils;
        Osd::CpuEvaluator::EvalStencils(points.data(), source, points.data(), target, table.GetSizes().data(),
                                        table.GetOffsets().data(), table.GetControlIndices().data(),
                                        table.GetWeights().data(), 0, table.GetNumStencils());
    }
};

extern "C" {

osd_status osd_bfr_peer_create(const osd_mesh *mesh, const double *points, int32_t smooth_level, int32_t sharp_level,
                               int32_t in_double, osd_bfr_peer **out) {
    return create(out, [&] {
        require(smooth_level >= 1 && smooth_level <= 10 && sharp_level >= 1 && sharp_level <= 10,
                "approximation levels must be 1 to 10");
        auto peer = std::make_unique<osd_bfr_peer>();
        peer->refiner = make_refiner(*mesh);
        Bfr::SurfaceFactory::Options options;
        options.SetApproxLevelSmooth(smooth_level);
        options.SetApproxLevelSharp(sharp_level);
        peer->factory = std::make_unique<Bfr::RefinerSurfaceFactory<>>(*peer->refiner, options);
        peer->ptex = list_ptex(*mesh);
        peer->in_double = in_double != 0;
        std::size_t const count = 3 * std::size_t(mesh->vertex_count);
        if (peer->in_double)
            peer->doubles.make(*peer->factory, *peer->refiner, std::vector<double>(points, points + count));
        else peer->singles.make(*peer->factory, *peer->refiner, std::vector<float>(points, points + count));
        return peer;
    });
}

void osd_bfr_peer_destroy(osd_bfr_peer *peer) { delete peer; }

osd_status osd_bfr_peer_evaluate(const osd_bfr_peer *peer, int32_t count, const int32_t *faces, const void *uv,
                                 void *jets) {
    return guard([&] {
        if (peer->in_double)
            peer->doubles.evaluate(peer->ptex, count, faces, static_cast<double const *>(uv),
                                   static_cast<double *>(jets));
        else
            peer->singles.evaluate(peer->ptex, count, faces, static_cast<float const *>(uv),
                                   static_cast<float *>(jets));
    });
}

osd_status osd_cpu_create(const osd_mesh *mesh, const double *points, int32_t isolation, osd_cpu **out) {
    return create(out, [&] {
        require(isolation >= 1 && isolation <= 10, "isolation must be 1 to 10");
        auto refiner = make_refiner(*mesh);
        Far::PatchTableFactory::Options options = exact_options(isolation);
        options.SetPatchPrecision<float>();
        refiner->RefineAdaptive(options.GetRefineAdaptiveOptions());

        auto cpu = std::make_unique<osd_cpu>();
        cpu->table.reset(Far::PatchTableFactory::Create(*refiner, options));
        if (!cpu->table) throw std::runtime_error("OpenSubdiv made no patch table");
        Far::StencilTableFactory::Options refined;
        refined.generateOffsets = true;
        refined.generateIntermediateLevels = true;
        cpu->stencils.reset(Far::StencilTableFactory::Create(*refiner, refined));
        if (Far::StencilTable const *local = cpu->table->GetLocalPointStencilTable()) {
            Far::StencilTable const *all =
                Far::StencilTableFactory::AppendLocalPointStencilTable(*refiner, cpu->stencils.get(), local);
            if (all) cpu->stencils.reset(all);
        }
        cpu->map = std::make_unique<Far::PatchMap>(*cpu->table);
        cpu->cpu_table = std::make_unique<Osd::CpuPatchTable>(cpu->table.get());
        cpu->control = std::size_t(mesh->vertex_count);
        cpu->points.resize(3 * (cpu->control + std::size_t(cpu->stencils->GetNumStencils())));
        std::vector<float> const control(points, points + 3 * cpu->control);
        cpu->update(control.data());
        return cpu;
    });
}

void osd_cpu_destroy(osd_cpu *cpu) { delete cpu; }

osd_status osd_cpu_update(osd_cpu *cpu, const float *points) {
    return guard([&] { cpu->update(points); });
}

osd_status osd_cpu_place(osd_cpu *cpu, int32_t count, const int32_t *faces, const float *uv) {
    return guard([&] {
        cpu->coordinates.clear();
        for (int32_t i = 0; i < count; ++i) {
            Far::PatchTable::PatchHandle const *handle = cpu->map->FindPatch(faces[i], uv[2 * i], uv[2 * i + 1]);
            if (handle) cpu->coordinates.emplace_back(*handle, uv[2 * i], uv[2 * i + 1]);
        }
    });
}

osd_status osd_cpu_placed(const osd_cpu *cpu, int32_t *out) {
    return guard([&] { *out = int32_t(cpu->coordinates.size()); });
}

osd_status osd_cpu_evaluate(const osd_cpu *cpu, float *jets) {
    return guard([&] {
        Osd::BufferDescriptor const source(0, 3, 3);
        Osd::BufferDescriptor const position(0, 3, 9), du(3, 3, 9), dv(6, 3, 9);
        Osd::CpuEvaluator::EvalPatches(cpu->points.data(), source, jets, position, jets, du, jets, dv,
                                       int(cpu->coordinates.size()), cpu->coordinates.data(),
                                       cpu->cpu_table->GetPatchArrayBuffer(), cpu->cpu_table->GetPatchIndexBuffer(),
                                       cpu->cpu_table->GetPatchParamBuffer());
    });
}

} // extern "C"
