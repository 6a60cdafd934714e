/* SPDX-License-Identifier: MIT */
/*
 * pmesh_decode.h - turns a .pmesh stream, or any prefix of one, into triangles
 * at any face budget. Safe on hostile input.
 *
 *   pmesh_decoder *dec;
 *   pmesh_decoder_create(&dec, NULL);
 *   while ((size = read_some(buffer)) > 0)
 *       if (pmesh_decoder_feed(dec, buffer, size) < 0)
 *           break;                       (the mesh so far stays usable)
 *   pmesh_decoder_refine(dec, &(pmesh_target){ .faces = 5000 }, NULL);
 *   pmesh_view view;
 *   pmesh_decoder_mesh(dec, &view);
 *   pmesh_decoder_copy_positions(dec, xyz, 0);
 *   draw(xyz, view.vertex_count, view.indices, 3 * view.face_count);
 *   pmesh_decoder_destroy(dec);
 *
 * feed() decodes what arrives; refine() moves the visible mesh up or down to a
 * budget among what is decoded, without reading bytes again. Vertices are
 * appended when refining and popped when coarsening, faces too; only the
 * corners next to a split are rewritten. With subset placement a vertex never
 * changes once it is there, but for the exact position of a lossless file.
 *
 * Two allocations: the handle, and one block when the header is known: 53 to 60
 * bytes a face of meshes of 30,000 faces and more without attributes. At most
 * 64 KiB of stack.
 *
 * The visible mesh is moved up and down in the memory of what is decoded. To
 * feed() while a coarser one is looked at after each call costs, for each, the
 * time of two refine() between them; to feed() and only then to look, nothing.
 * No globals, threads, files, or floating point before dequantisation: the
 * result depends on the bytes alone, on every compiler and CPU.
 */
#ifndef PMESH_DECODE_H
#define PMESH_DECODE_H

#include "format/pmesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pmesh_decoder pmesh_decoder;

typedef struct pmesh_decoder_config {
    pmesh_allocator allocator; /* default: malloc and free */
    uint64_t max_memory;       /* bytes of the block; 0: 4 GiB */
    uint32_t max_faces;        /* 0: 2^28 */
    pmesh_base_decode base_decoder; /* for files with a Draco base mesh; NULL:
                                       they end with E_UNSUPPORTED. What it
                                       allocates is its own affair */
    void *base_user;
} pmesh_decoder_config;

PMESH_API pmesh_decoder_config pmesh_decoder_config_default(void);

/*
 * Makes a decoder; config NULL stands for the default. Returns PMESH_OK, or
 * E_ARGUMENT or E_MEMORY with *out = NULL.
 */
PMESH_API pmesh_status pmesh_decoder_create(pmesh_decoder **out,
                                            const pmesh_decoder_config *config);

/* Frees everything; accepts NULL. */
PMESH_API void pmesh_decoder_destroy(pmesh_decoder *dec);

/*
 * Gives the next bytes of a stream to the decoder. Safe on hostile input.
 *
 * Chunk boundaries carry no meaning: one call with 1000 bytes and 1000 calls
 * with one byte leave the same state. No pointer into `data` is kept. The
 * visible mesh does not change, except that it becomes the base mesh when that
 * arrives: call refine() to see more.
 *
 * Returns PMESH_OK once the end of the file was read (further bytes are
 * ignored), PMESH_NEED_DATA before. A negative status is final: later calls
 * return it again, and the mesh stays readable and refinable as far as it was
 * decoded: E_MAGIC, E_VERSION, E_CORRUPT, E_CHECKSUM, E_LIMIT, E_MEMORY,
 * E_UNSUPPORTED.
 */
PMESH_API pmesh_status pmesh_decoder_feed(pmesh_decoder *dec, const void *data,
                                          size_t size);

/* Where feed() failed: byte offset of the chunk or record, and the rule. */
typedef struct pmesh_decode_error {
    pmesh_status status;
    uint64_t offset;  /* bytes from the start of the stream */
    const char *rule; /* "SPEC 5.3: ..." static text; "" if no error */
} pmesh_decode_error;

PMESH_API pmesh_decode_error pmesh_decoder_error(const pmesh_decoder *dec);

/* All that the header tells; counts are those of full detail. */
typedef struct pmesh_header {
    uint32_t format_version;
    uint64_t content_hash; /* names the content; equal files, equal hash */
    uint64_t bytes;        /* the complete file */
    pmesh_profile profile;
    pmesh_placement placement;
    pmesh_base_coder base_coder;
    int joined;             /* non-zero: sheets and pieces may meet in a mesh
                               vertex, and part at finer levels */
    pmesh_grid grid;
    int32_t bounds[3];      /* largest grid coordinate of each axis */
    uint32_t faces;
    uint32_t mesh_vertices; /* distinct positions */
    uint32_t vertices;      /* output vertices; = mesh_vertices without seams */
    uint32_t base_faces, base_mesh_vertices, base_vertices;
    uint32_t material_count;
    uint32_t attribute_count;
    pmesh_attribute attributes[PMESH_MAX_ATTRIBUTES];
    uint32_t level_count;   /* levels[0] is the base mesh */
    pmesh_level levels[PMESH_MAX_LEVELS];
    uint64_t exact_bytes;   /* of a lossless file: what its exact positions take
                               behind the last level; 0: it has none */
    uint64_t memory;        /* bytes of the decoder's block for this file */
    int measured;           /* non-zero: levels have rms and furthest */
} pmesh_header;

/* Copies the header. PMESH_NEED_DATA until it has arrived; else PMESH_OK. */
PMESH_API pmesh_status pmesh_decoder_header(const pmesh_decoder *dec,
                                            pmesh_header *out);

/* How far decoding came. */
typedef struct pmesh_progress_state {
    uint64_t bytes;       /* consumed by complete chunks, from the start */
    uint32_t faces;       /* decoded: refine() reaches up to here */
    uint32_t levels;      /* complete levels, the base included */
    uint32_t exact_vertices; /* mesh vertices, from the first on, whose exact
                                position has arrived */
    int complete;         /* 1: the whole file was decoded */
} pmesh_progress_state;

PMESH_API pmesh_progress_state
pmesh_decoder_progress(const pmesh_decoder *dec);

/*
 * Where to go: as fine as decoded within every limit given; 0 is no limit.
 *   faces   at most this many (never below the base mesh)
 *   error   the coarsest complete level whose error is at most this; model
 *           units; if none is decoded, the finest
 *   bytes   the levels that the first `bytes` bytes of the file hold
 *   max_ops splits to show or hide in one call, for a budget per frame
 *           (tests/bench/refine.sh measures what one costs)
 */
typedef struct pmesh_target {
    uint32_t faces;
    double error;
    uint64_t bytes;
    uint32_t max_ops;
} pmesh_target;

typedef struct pmesh_range {
    uint32_t first, count;
} pmesh_range;

/*
 * What a refine() changed, and feed() since the refine() before it (the base
 * mesh, exact positions): upload these and nothing else. Sorted, disjoint, in
 * elements (output vertices, index triples); beyond the buffers' new ends
 * nothing is listed. Every range begins and ends with an element that changed;
 * if there are more runs of those than ranges, the narrowest gaps between them
 * are listed, too: fewer elements cannot be in so many ranges. Small steps touch
 * corners all over a mesh: of bunny, 1 % of the faces touch some 1000 runs, and
 * 64 ranges list 13 times what changed, 256 would 7 times, 1024 once. But each is
 * a call of the graphics interface, which costs as much as kilobytes.
 */
#define PMESH_MAX_RANGES 64
typedef struct pmesh_changes {
    uint32_t vertex_range_count, face_range_count;
    pmesh_range vertices[PMESH_MAX_RANGES];
    pmesh_range faces[PMESH_MAX_RANGES];
} pmesh_changes;

/*
 * Moves the visible mesh to the target. target NULL: all that is decoded.
 * changes: NULL or filled. Exact to one face (two where a split adds two).
 * Returns PMESH_OK at the target, PMESH_MORE if max_ops ended the way to it, or
 * PMESH_NEED_DATA while no base mesh has been decoded.
 */
PMESH_API pmesh_status pmesh_decoder_refine(pmesh_decoder *dec,
                                            const pmesh_target *target,
                                            pmesh_changes *changes);

/* The visible mesh; pointers are valid until the next feed() or refine(). */
typedef struct pmesh_view {
    uint32_t vertex_count; /* output vertices in use: a prefix of the file's */
    uint32_t mesh_vertex_count;
    uint32_t face_count;
    const uint32_t *indices;   /* 3 per face, into the output vertices */
    const uint32_t *positions_of; /* output vertex -> mesh vertex; NULL: same */
    const int32_t *positions;  /* 3 grid coordinates per mesh vertex */
    const uint16_t *values;    /* per output vertex: all attributes' coded
                                  components, one after the other; or NULL */
    uint32_t value_stride;     /* components per output vertex */
    const uint32_t *materials; /* per face; NULL: all 0 */
    float error;               /* of the finest complete level at or below */
} pmesh_view;

PMESH_API pmesh_status pmesh_decoder_mesh(const pmesh_decoder *dec,
                                          pmesh_view *out);

/*
 * Memory of the caller that refine() keeps equal to the visible mesh: mapped
 * buffers of a graphics card, say. It is written, never read, and nothing but
 * what `changes` would list. NULL: that part is not wanted.
 */
typedef struct pmesh_buffers {
    void *indices;        /* 3 per face, for header.faces */
    uint32_t index_size;  /* of one index: 4, or 2 if header.vertices is at most
                             65536; 0 stands for 4 */
    float *positions;     /* 3 floats each, for header.vertices */
    size_t position_stride; /* bytes from one to the next; 0: packed */
    float *attributes[PMESH_MAX_ATTRIBUTES]; /* `components` floats each */
    size_t attribute_strides[PMESH_MAX_ATTRIBUTES];
} pmesh_buffers;

/*
 * Binds the caller's buffers, of which the decoder keeps a copy of the
 * pointers, and writes what is visible. buffers NULL: none from now on. The
 * memory must stay until then, or until the decoder is destroyed.
 *
 * Returns PMESH_OK, PMESH_NEED_DATA before the header (nothing is bound), or
 * E_ARGUMENT: indices too small, a stride shorter than its tuple, or an
 * attribute that the file lacks.
 */
PMESH_API pmesh_status pmesh_decoder_bind(pmesh_decoder *dec,
                                          const pmesh_buffers *buffers);

/*
 * Copies the visible faces sorted by material, for one draw call each:
 * `groups`, of header.material_count, gets the triples of each material (NULL:
 * not wanted). index_size as above; the buffer holds view.face_count triples.
 * Within a material the faces keep their order. Returns PMESH_OK, NEED_DATA, or
 * E_ARGUMENT.
 */
PMESH_API pmesh_status pmesh_decoder_copy_indices(const pmesh_decoder *dec,
                                                  void *dst,
                                                  uint32_t index_size,
                                                  pmesh_range *groups);

/*
 * Dequantises into the caller's memory, one tuple per output vertex of the
 * visible mesh, `stride` bytes apart (0: packed). The buffer must hold
 * view.vertex_count tuples. Returns PMESH_OK, NEED_DATA, or E_ARGUMENT.
 *
 * Exact positions of a lossless file follow its last level. A mesh vertex below
 * progress.exact_vertices gets the floats of the input, bit for bit, at every
 * budget; where vertices move (PMESH_OPTIMAL), only if it stands on the grid
 * point where the full mesh has it, as all do at full detail. Others get their
 * grid point, at most 0.87 steps away. So when exact_vertices has grown from a
 * to b, positions of mesh vertices a .. b - 1 are to be copied again; the next
 * refine() lists them.
 */
PMESH_API pmesh_status pmesh_decoder_copy_positions(const pmesh_decoder *dec,
                                                    float *dst, size_t stride);

/*
 * The same, but swollen to the volume of the full mesh, which brings coarse
 * levels 10 to 20 % closer to it (SPEC 7.1): for the eye. Vertices at a
 * boundary stay, and at full detail all do. Positions of all vertices change
 * with every refine(), whatever it lists. `room` is scratch memory of
 * pmesh_decoder_inflate_room() bytes, aligned for any object: that many for the
 * mesh that is visible now. Returns as above.
 */
PMESH_API size_t pmesh_decoder_inflate_room(const pmesh_decoder *dec);
PMESH_API pmesh_status pmesh_decoder_copy_inflated(const pmesh_decoder *dec,
                                                   float *dst, size_t stride,
                                                   void *room);

PMESH_API pmesh_status pmesh_decoder_copy_attribute(const pmesh_decoder *dec,
                                                    uint32_t attribute,
                                                    float *dst, size_t stride);

/* Name of a material, "" if it has none; valid while the decoder lives. */
PMESH_API const char *pmesh_decoder_material_name(const pmesh_decoder *dec,
                                                  uint32_t material);

/*
 * The vertex that a mesh vertex was split from; UINT32_MAX for vertices of the
 * base mesh and those not decoded. A parent has the smaller number.
 */
PMESH_API uint32_t pmesh_decoder_parent(const pmesh_decoder *dec,
                                        uint32_t mesh_vertex);

/*
 * For geomorphs: where the output vertices of the visible mesh lie on the
 * coarser mesh `coarse` (max_ops has no meaning), as copy_positions(). A vertex
 * that the coarse mesh lacks lies at its nearest ancestor there.
 *
 * Blend: position = from + t * (to - from), `from` by this call and `to` by
 * copy_positions(). With t = 0 the visible mesh covers the coarse one, the
 * faces that are not there having no area; with t = 1 it is itself. Draw the
 * visible mesh for 0 < t <= 1 and step t evenly over some 200 to 500 ms, or by
 * the distance to the camera. Attributes are not blended: a vertex has its own
 * from the start.
 *
 * Returns PMESH_OK, NEED_DATA, or E_ARGUMENT. The visible mesh is the same
 * afterwards; the work is that of a refine() to `coarse` and back.
 */
PMESH_API pmesh_status pmesh_decoder_copy_morph(pmesh_decoder *dec,
                                                const pmesh_target *coarse,
                                                float *dst, size_t stride);

/*
 * Box around the visible mesh, in model units. Every visible mesh lies in the
 * box of the grid: grid.origin to grid.origin + grid.step * bounds.
 */
PMESH_API pmesh_status pmesh_decoder_bounds(const pmesh_decoder *dec,
                                            double minimum[3],
                                            double maximum[3]);

/* Where a ray meets the visible mesh. */
typedef struct pmesh_hit {
    uint32_t face;
    double distance;  /* in lengths of the direction */
    double weight[3]; /* of the face's corners; their sum is 1 */
} pmesh_hit;

/*
 * The first face that the ray meets, from either side, at a distance of 0 or
 * more. Tests every visible face (grid positions): for a click, not for every
 * pixel. Returns 1 and fills *hit, or 0: nothing met, no mesh, or a direction
 * of no length.
 */
PMESH_API int pmesh_decoder_raycast(const pmesh_decoder *dec,
                                    const double origin[3],
                                    const double direction[3], pmesh_hit *hit);

#ifdef __cplusplus
}
#endif
#endif
