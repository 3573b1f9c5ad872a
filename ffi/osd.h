/*
 * The whole C interface between catoptric and OpenSubdiv (3.5.0 up to below 4.0). bindgen reads this file alone.
 *
 * Conventions
 *  - Every function that can fail returns an osd_status; after OSD_FAILED, osd_message() says why (one line, valid until
 *    the next call on the same thread). After a failure arrays are unspecified, and handles untouched: there is nothing
 *    to release.
 *  - Arrays are owned by the caller and sized as stated; points are x, y, z in double precision.
 *  - Objects made by *_create are owned by the caller and released once by the matching *_destroy (NULL is allowed).
 *  - The caller validates meshes: OpenSubdiv reads out of bounds on indices that are out of range.
 */
#ifndef CATOPTRIC_OSD_H
#define CATOPTRIC_OSD_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum osd_status { OSD_OK = 0, OSD_FAILED = 1 } osd_status;

const char *osd_message(void);
/* Version of the headers that the shim was compiled with, such as "3.5.0". */
const char *osd_version(void);

/* ---- the process ------------------------------------------------------------------------------------------------- */

/* 1 if the process was started without a standard output. */
int32_t osd_stdout_was_closed(void);
/* All threads that come allocate from one arena; nothing where the allocator has none (elsewhere than in glibc). */
void osd_share_one_arena(void);
/* Signals such as SIGSEGV end the process with one line on standard error and exit code 2 from now on. */
void osd_name_fatal_signals(void);

/* Ends the process at once: nothing is flushed, and no destructor runs. */
void osd_end_process(int32_t code);

/* ---- control mesh ------------------------------------------------------------------------------------------------ */

typedef enum osd_boundary { OSD_BOUNDARY_NONE, OSD_BOUNDARY_EDGE_ONLY, OSD_BOUNDARY_EDGE_AND_CORNER } osd_boundary;
typedef enum osd_creasing { OSD_CREASING_UNIFORM, OSD_CREASING_CHAIKIN } osd_creasing;
/* How CATMULL_CLARK refines triangles; the other schemes take no notice. */
typedef enum osd_triangles { OSD_TRIANGLES_CATMULL_CLARK, OSD_TRIANGLES_SMOOTH } osd_triangles;

/* Triangles alone under LOOP. */
typedef enum osd_scheme { OSD_SCHEME_CATMULL_CLARK, OSD_SCHEME_LOOP, OSD_SCHEME_BILINEAR } osd_scheme;

typedef struct osd_mesh {
    int32_t vertex_count;
    int32_t face_count;
    const int32_t *face_sizes;        /* face_count */
    const int32_t *face_vertices;     /* sum of face_sizes */
    int32_t crease_count;
    const int32_t *crease_vertices;   /* 2 * crease_count */
    const float *crease_sharpness;    /* crease_count */
    int32_t corner_count;
    const int32_t *corner_vertices;   /* corner_count */
    const float *corner_sharpness;    /* corner_count */
    int32_t hole_count;
    const int32_t *holes;             /* hole_count */
    osd_scheme scheme;
    osd_boundary boundary;
    osd_creasing creasing;
    osd_triangles triangles;
} osd_mesh;

/* ---- topology refinement ----------------------------------------------------------------------------------------- */

typedef struct osd_refiner osd_refiner;

/* Copies the mesh; level 0 exists afterwards. */
osd_status osd_refiner_create(const osd_mesh *mesh, osd_refiner **out);
void osd_refiner_destroy(osd_refiner *refiner);

/*
 * Feature-adaptive refinement, infinitely sharp patches on. Features other than semi-sharp ones are isolated to
 * `secondary` only; with `single_crease`, faces along a regular crease of constant sharpness are not refined either.
 * isolation in 1..10 (3.5.0 corrupts memory above 10), once per refiner.
 */
osd_status osd_refiner_refine_adaptive(osd_refiner *refiner, int32_t isolation, int32_t secondary,
                                       int32_t single_crease);
/* Uniform refinement with full topology in the last level; once per refiner. */
osd_status osd_refiner_refine_uniform(osd_refiner *refiner, int32_t level);

typedef struct osd_level_sizes {
    int32_t vertices;
    int32_t edges;
    int32_t faces;
    int32_t face_vertices;            /* sum of the face sizes */
} osd_level_sizes;

osd_status osd_refiner_level_count(const osd_refiner *refiner, int32_t *out);
osd_status osd_refiner_level_sizes(const osd_refiner *refiner, int32_t level, osd_level_sizes *out);

typedef enum osd_rule { OSD_RULE_SMOOTH, OSD_RULE_DART, OSD_RULE_CREASE, OSD_RULE_CORNER, OSD_RULE_UNKNOWN } osd_rule;

/* Buffers that osd_refiner_level fills. In the last level, and beyond the refined region, children are -1. */
typedef struct osd_level_arrays {
    int32_t *face_offsets;            /* faces + 1: face f has face_vertices[face_offsets[f] .. face_offsets[f+1]] */
    int32_t *face_vertices;           /* face_vertices */
    int32_t *face_edges;              /* face_vertices: edge i runs from vertex i to vertex i+1 */
    int32_t *face_children;           /* face_vertices: the child at vertex i */
    int32_t *face_middles;            /* faces: under LOOP the child that has none of its vertices, else -1 */
    uint8_t *face_holes;              /* faces: 1 for holes, faces that the boundary rule leaves out included */
    int32_t *edge_faces;              /* 2 * edges: second is -1 on a boundary, both are -2 where not manifold */
    float *edge_sharpness;            /* edges: 10 is infinite */
    float *vertex_sharpness;          /* vertices: 10 is infinite */
    uint8_t *vertex_rules;            /* vertices: an osd_rule */
    int32_t *vertex_children;         /* vertices: child vertex in the next level */
} osd_level_arrays;

osd_status osd_refiner_level(const osd_refiner *refiner, int32_t level, const osd_level_arrays *out);

/* points: 3 * vertices of level 0; out: 3 * vertices of levels 0, 1, ... one after the other. */
osd_status osd_refiner_interpolate(const osd_refiner *refiner, const double *points, double *out);
/*
 * Limit positions and two tangents by OpenSubdiv's masks. All arrays: 3 * vertices of the last level (uniform
 * refinement). `crowded`: the vertices that OpenSubdiv's masks have no room for, because they are not manifold and have more
 * faces than edges; it would write beyond its arrays, so if there is one it is not asked, and the arrays stay as they are.
 */
osd_status osd_refiner_limit(const osd_refiner *refiner, const double *points, double *positions, double *tangents_1,
                             double *tangents_2, int32_t *crowded);

/* ---- reference evaluators ---------------------------------------------------------------------------------------- */

/*
 * What answered: nothing (a hole), an exact B-spline patch, an approximating end cap; or the reference was not asked,
 * because 3.5.0 reads out of bounds there (Bfr, faces with a vertex where two faces share two edges, as at interior valence 2).
 */
typedef enum osd_answer {
    OSD_ANSWER_NONE,
    OSD_ANSWER_REGULAR,
    OSD_ANSWER_END_CAP,
    OSD_ANSWER_NOT_ASKED
} osd_answer;

/* What stands for the surface where refinement ends at a feature. */
typedef enum osd_end_cap { OSD_END_CAP_GREGORY, OSD_END_CAP_BSPLINE, OSD_END_CAP_BILINEAR } osd_end_cap;

/* Bits: options of Far::PatchTableFactory in which a table is made by the library's choice instead of ours. */
typedef enum osd_far_option {
    OSD_FAR_SMOOTHED_CREASES = 1,     /* useInfSharpPatch = false, the library's default */
    OSD_FAR_LEGACY_CORNERS = 2,       /* generateLegacySharpCornerPatches = true, the library's default */
    OSD_FAR_SINGLE_CREASE = 4         /* useSingleCreasePatch = true */
} osd_far_option;

/*
 * Far::PatchTable in double precision. Sharp features are isolated to `isolation`, 1..10, all others to `secondary`,
 * 1..isolation. options: bits of osd_far_option, 0 for tables that are exact where they can be.
 */
typedef struct osd_far osd_far;
osd_status osd_far_create(const osd_mesh *mesh, const double *points, int32_t isolation, int32_t secondary,
                          osd_end_cap end_cap, int32_t options, osd_far **out);
void osd_far_destroy(osd_far *far);

/* What a patch table holds. */
typedef struct osd_far_sizes {
    int64_t patches;
    int64_t control_points;           /* sum over the patches */
    int64_t bytes;                    /* control vertex indices, patch parameters, and its points in double precision */
} osd_far_sizes;
osd_status osd_far_measure(const osd_far *far, osd_far_sizes *out);

/* A patch of the table. */
typedef struct osd_far_patch {
    double origin[2];                 /* (u,v) of its first corner, in parameters of the ptex face */
    int32_t face;                     /* ptex face */
    int32_t points;                   /* 16: a bicubic B-spline; 20: a Gregory patch (Far::PatchDescriptor); 4: bilinear;
                                         12, 18: those of triangles */
    uint8_t depth;                    /* its side is 2^-depth of the ptex face */
    uint8_t level;                    /* refinement level of its face in the control mesh */
    uint8_t boundary;                 /* bit i: beyond edge i there are no control points, those given mean nothing */
    uint8_t transition;               /* bit i: smaller patches beyond edge i; edges v=0, u=1, v=1, u=0 */
    uint8_t end_cap;                  /* 1: approximates */
    uint8_t padding[3];
} osd_far_patch;
/* patches: one each; points: 3 * control_points, patch by patch. */
osd_status osd_far_patches(const osd_far *far, osd_far_patch *patches, double *points);

/* Bfr surfaces in double precision; approximation levels in 1..10 (the library's defaults are 2 and 6). */
typedef struct osd_bfr osd_bfr;
osd_status osd_bfr_create(const osd_mesh *mesh, const double *points, int32_t smooth_level, int32_t sharp_level,
                          osd_bfr **out);
void osd_bfr_destroy(osd_bfr *bfr);

/*
 * Far::LimitStencilTable in double precision: every sample as a weighted sum of control points. Its patches are those of
 * osd_far_create, refined anew in every call round the faces that are asked for, so memory grows with a call's faces and
 * with the control mesh. Calls do not change the object: any number of threads may make them.
 */
typedef struct osd_stencils osd_stencils;
osd_status osd_stencils_create(const osd_mesh *mesh, int32_t isolation, osd_stencils **out);
void osd_stencils_destroy(osd_stencils *stencils);
/*
 * As osd_far_evaluate, with the control points (3 * vertices) and, for each sample, the number of control points that
 * its stencil sums (terms: count). Samples come grouped by ptex face.
 */
osd_status osd_stencils_evaluate(const osd_stencils *stencils, const double *points, int32_t count,
                                 const int32_t *faces, const double *uv, double *jets, double *cells, uint8_t *answers,
                                 int32_t *terms);
/*
 * The stencil of one sample. size: its control points, 0 in a hole; of these up to `capacity` are written. vertices:
 * capacity; weights: 3 * capacity, those of position, d/du, d/dv; kind: an osd_answer.
 */
osd_status osd_stencils_weights(const osd_stencils *stencils, int32_t face, const double *uv, int32_t capacity,
                                int32_t *size, int32_t *vertices, double *weights, uint8_t *kind);

/*
 * Evaluates `count` samples. faces: ptex faces; uv: 2 * count, in [0,1]; jets: 9 * count, position, d/du, d/dv by the
 * parameters of the ptex face; cells: count, the side of the patch that answered in those parameters (1 for Bfr, whose
 * exact surfaces are whole faces); answers: count, an osd_answer each. osd_far_evaluate does not change its object: any
 * number of threads may call it. Bfr's cache does change: one thread at a time.
 */
osd_status osd_far_evaluate(const osd_far *far, int32_t count, const int32_t *faces, const double *uv, double *jets,
                            double *cells, uint8_t *answers);
osd_status osd_bfr_evaluate(osd_bfr *bfr, int32_t count, const int32_t *faces, const double *uv, double *jets,
                            double *cells, uint8_t *answers);

/* ---- peers of benchmarks ----------------------------------------------------------------------------------------- */

/*
 * Bfr as its users have it: the surfaces of all faces with their patch points, in single or double precision. Faces that Bfr must
 * not be asked for, and holes, have none: their jets are zero. One thread at a time.
 */
typedef struct osd_bfr_peer osd_bfr_peer;
osd_status osd_bfr_peer_create(const osd_mesh *mesh, const double *points, int32_t smooth_level, int32_t sharp_level,
                               int32_t in_double, osd_bfr_peer **out);
void osd_bfr_peer_destroy(osd_bfr_peer *peer);
/* uv: 2 * count, jets: 9 * count, of float or double as the peer is; faces in range. */
osd_status osd_bfr_peer_evaluate(const osd_bfr_peer *peer, int32_t count, const int32_t *faces, const void *uv,
                                 void *jets);

/*
 * Osd::CpuEvaluator (single precision) over an adaptive patch table with Gregory end caps, everything isolated to `isolation`, and the
 * stencils that make its points of control points.
 */
typedef struct osd_cpu osd_cpu;
osd_status osd_cpu_create(const osd_mesh *mesh, const double *points, int32_t isolation, osd_cpu **out);
void osd_cpu_destroy(osd_cpu *cpu);
/* points: 3 * vertices of the control mesh. */
osd_status osd_cpu_update(osd_cpu *cpu, const float *points);
/* Finds the patches of samples, uv: 2 * count; holes are left out. */
osd_status osd_cpu_place(osd_cpu *cpu, int32_t count, const int32_t *faces, const float *uv);
/* How many samples were placed. */
osd_status osd_cpu_placed(const osd_cpu *cpu, int32_t *out);
/* jets: 9 * count for the samples that were placed last; derivatives in an n-gon's quadrants are twice as long. */
osd_status osd_cpu_evaluate(const osd_cpu *cpu, float *jets);

#ifdef __cplusplus
}
#endif
#endif
