/* SPDX-License-Identifier: MIT */
/*
 * pmesh_scene.h - many meshes out of one file, at one budget.
 *
 * A scene file interleaves the streams of its meshes, so that any prefix shows
 * the whole scene as well as that many bytes can; besides it carries a document
 * (of a glTF scene its JSON) and resources (images, animations), which are bytes
 * to us.
 *
 *   pmesh_scene *scene;
 *   pmesh_scene_create(&scene, NULL);
 *   while ((size = read_some(buffer)) > 0)
 *       if (pmesh_scene_feed(scene, buffer, size) < 0)
 *           break;                      (what came before stays usable)
 *   pmesh_scene_refine(scene, &(pmesh_scene_target){ .faces = 100000 }, NULL);
 *   for (uint32_t i = 0; i < header.mesh_count; i++)
 *       draw(pmesh_scene_mesh(scene, i));        (see pmesh_decode.h)
 *   pmesh_scene_destroy(scene);
 *
 * Faces and vertices count each mesh once, however many instances it has. An
 * error is a distance in world units: a mesh's own, times the largest scale of
 * its instances; a scene's is the largest of its meshes'.
 *
 * Safe on hostile input, without globals, threads and files. Allocations: the
 * handle; once the header is known its bytes (released again) and one block;
 * two for each mesh when it begins to arrive.
 */
#ifndef PMESH_SCENE_H
#define PMESH_SCENE_H

#include "decoder/pmesh_decode.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct pmesh_scene pmesh_scene;

typedef struct pmesh_scene_config {
    pmesh_decoder_config decoder; /* of every mesh; max_memory is for the whole
                                     scene, resources included */
    int skip_resources; /* non-zero: they are checked, but not kept */
} pmesh_scene_config;

/*
 * Makes a scene; config NULL stands for zeros. Returns PMESH_OK, or E_ARGUMENT
 * or E_MEMORY with *out = NULL.
 */
PMESH_API pmesh_status pmesh_scene_create(pmesh_scene **out,
                                          const pmesh_scene_config *config);

/* Frees everything, the meshes' decoders too; accepts NULL. */
PMESH_API void pmesh_scene_destroy(pmesh_scene *scene);

/*
 * Whether these are the first bytes of a scene, of a single mesh or of neither:
 * PMESH_OK, PMESH_E_UNSUPPORTED, PMESH_E_MAGIC; PMESH_NEED_DATA while fewer than
 * 9 bytes leave it open.
 */
PMESH_API pmesh_status pmesh_scene_probe(const void *data, size_t size);

/*
 * Gives the next bytes of the file; the rules of pmesh_decoder_feed(). Status
 * E_UNSUPPORTED also says that the file holds a single mesh. A failure of one
 * mesh ends the scene.
 */
PMESH_API pmesh_status pmesh_scene_feed(pmesh_scene *scene, const void *data,
                                        size_t size);

/* Where feed() failed: as pmesh_decoder_error(). */
PMESH_API pmesh_decode_error pmesh_scene_error(const pmesh_scene *scene);

typedef struct pmesh_scene_header {
    uint64_t content_hash;
    pmesh_document_form document_form;
    uint64_t document_bytes; /* as stored in that form */
    uint32_t mesh_count, resource_count;
    uint32_t level_count; /* levels[0]: all base meshes, the last: all there is
                             of the meshes but exact positions */
    pmesh_scene_level levels[PMESH_MAX_LEVELS];
} pmesh_scene_header;

/* Copies the header. PMESH_NEED_DATA until it has arrived; else PMESH_OK. */
PMESH_API pmesh_status pmesh_scene_get_header(const pmesh_scene *scene,
                                              pmesh_scene_header *out);

typedef struct pmesh_scene_progress {
    uint64_t bytes;  /* consumed by complete chunks */
    uint64_t faces;  /* decoded of all meshes */
    uint32_t bases;  /* meshes whose base mesh is there */
    int document;    /* 1: all of the document is there */
    int complete;    /* 1: the whole file was decoded */
} pmesh_scene_progress;

PMESH_API pmesh_scene_progress
pmesh_scene_get_progress(const pmesh_scene *scene);

/*
 * The decoder of a mesh, NULL until its first bytes have arrived. It lives as
 * long as the scene; the caller may look at it and refine it by itself, but
 * neither feed nor destroy it. mesh < mesh_count.
 */
PMESH_API pmesh_decoder *pmesh_scene_mesh(pmesh_scene *scene, uint32_t mesh);

/* Largest scale of a mesh's instances; 0: nothing shows it. */
PMESH_API float pmesh_scene_scale(const pmesh_scene *scene, uint32_t mesh);

/* Bytes that belong to the scene and stay valid as long as it does. */
typedef struct pmesh_scene_bytes {
    const uint8_t *data; /* NULL: not kept, or none at all */
    uint64_t size;       /* of all of it */
    uint64_t arrived;    /* how many are there */
} pmesh_scene_bytes;

/* The document, in the form that the header tells, and a resource <
 * resource_count; zeros before the header. */
PMESH_API pmesh_scene_bytes pmesh_scene_document(const pmesh_scene *scene);
PMESH_API pmesh_scene_bytes pmesh_scene_resource(const pmesh_scene *scene,
                                                 uint32_t resource);

/*
 * Where to go: as fine as decoded within every limit given; 0 is no limit.
 *   faces   at most this many of all meshes together, never below the bases
 *   error   each mesh at the coarsest complete level within this distance, in
 *           world units; its finest, if none is
 *   bytes   the complete levels that the file's first `bytes` bytes hold
 */
typedef struct pmesh_scene_target {
    uint64_t faces;
    double error;
    uint64_t bytes;
} pmesh_scene_target;

/* What is shown. */
typedef struct pmesh_scene_shown {
    uint64_t faces;
    uint32_t meshes; /* that have a base mesh */
    double error;    /* of the worst of them */
} pmesh_scene_shown;

/*
 * Refines or coarsens every mesh that has arrived. The faces go, level by
 * level, to the mesh whose error is the largest; a level that is too large for
 * what is left is shown in part, and ends it. target NULL: all that is decoded.
 * shown: NULL or filled.
 *
 * Returns PMESH_OK, or PMESH_NEED_DATA while there is no base mesh at all.
 */
PMESH_API pmesh_status pmesh_scene_refine(pmesh_scene *scene,
                                          const pmesh_scene_target *target,
                                          pmesh_scene_shown *shown);

/*
 * Only says how refine() would share the target: faces of each mesh, 0 before
 * its base mesh is there; `faces` holds mesh_count numbers. For callers who
 * refine each mesh by pmesh_decoder_refine(): with the ranges that changed, a
 * budget of work for a frame, or a look at what is in the picture. Returns as
 * refine().
 */
PMESH_API pmesh_status pmesh_scene_share(pmesh_scene *scene,
                                         const pmesh_scene_target *target,
                                         uint32_t *faces);

#ifdef __cplusplus
}
#endif
#endif
