/*
 * Embree 3.13, a peer of benchmarks alone (cargo feature `peers`). Conventions as in osd.h; failures are told by osd_message().
 */
#ifndef CATOPTRIC_EMBREE_H
#define CATOPTRIC_EMBREE_H

#include "osd.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A subdivision mesh, evaluated by rtcInterpolateN in single precision. */
typedef struct emb_subdivision emb_subdivision;
osd_status emb_subdivision_create(const osd_mesh *mesh, const double *points, emb_subdivision **out);
void emb_subdivision_destroy(emb_subdivision *subdivision);
/*
 * faces, u, v: count; faces are those of the mesh, and (u,v) of an n-gon as Embree encodes its quadrants. out: for every
 * EMB_BATCH samples, and for those that are left, 9 arrays of a number a sample: x, y, z, and those of du and dv.
 */
enum { EMB_BATCH = 256 };
osd_status emb_subdivision_evaluate(const emb_subdivision *subdivision, int32_t count, const uint32_t *faces,
                                    const float *u, const float *v, float *out);

/* Triangles to be hit by rays. */
typedef struct emb_triangles emb_triangles;
/* points: 3 * point_count, indices: 3 * triangle_count, in range. */
osd_status emb_triangles_create(int32_t point_count, const float *points, int32_t triangle_count,
                                const uint32_t *indices, int32_t threads, emb_triangles **out);
void emb_triangles_destroy(emb_triangles *triangles);
/*
 * A ray a pixel from the eye through first + x * right + y * down, on so many threads; hits: how many met a triangle. depths: width *
 * height, how far in lengths of the ray's direction, or infinite.
 */
typedef struct emb_camera {
    float eye[3], first[3], right[3], down[3];
    int32_t width, height;
} emb_camera;
osd_status emb_triangles_trace(const emb_triangles *triangles, const emb_camera *camera, int32_t threads,
                               float *depths, int64_t *hits);

#ifdef __cplusplus
}
#endif
#endif
