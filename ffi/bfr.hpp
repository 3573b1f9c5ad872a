// What the reference and the peer of benchmarks ask Bfr.
#pragma once
#include "guard.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace catoptric {

struct Ptex {
    int face, sub_face; // sub_face is -1 for a face that is one ptex face
};

inline std::vector<Ptex> list_ptex(osd_mesh const &mesh) {
    std::vector<Ptex> ptex;
    for (int face = 0; face < mesh.face_count; ++face) {
        int const size = mesh.face_sizes[face];
        if (ptex_faces(mesh, size) == 1) ptex.push_back({face, -1});
        else
            for (int corner = 0; corner < size; ++corner) ptex.push_back({face, corner});
    }
    return ptex;
}

// Bfr's IrregularPatchBuilder loses track of faces that overlap round a vertex, two that share both their edges there (an interior
// vertex of valence 2, or a part of one that is not manifold): it reads beyond its arrays, and sometimes crashes.
inline bool has_overlap(Far::TopologyRefiner const &refiner, int vertex) {
    Far::TopologyLevel const level = refiner.GetLevel(0);
    auto const faces = level.GetVertexFaces(vertex);
    auto const places = level.GetVertexFaceLocalIndices(vertex);
    std::vector<std::pair<int, int>> sides;
    for (int i = 0; i < faces.size(); ++i) {
        auto const edges = level.GetFaceEdges(faces[i]);
        int const next = edges[places[i]], last = edges[(places[i] + edges.size() - 1) % edges.size()];
        sides.emplace_back(std::min(next, last), std::max(next, last));
    }
    std::sort(sides.begin(), sides.end());
    return std::adjacent_find(sides.begin(), sides.end()) != sides.end();
}

inline bool is_safe(Far::TopologyRefiner const &refiner, int face) {
    auto const vertices = refiner.GetLevel(0).GetFaceVertices(face);
    return std::none_of(vertices.begin(), vertices.end(), [&](int v) { return has_overlap(refiner, v); });
}

} // namespace catoptric
