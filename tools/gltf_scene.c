/* SPDX-License-Identifier: MIT */
/* gltf_scene.c - from the node tree to placed meshes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/gltf.h"

typedef double affine[12]; /* three rows of four */

static void compose(const gltf_node *node, affine out)
{
    double x = node->rotation[0], y = node->rotation[1];
    double z = node->rotation[2], w = node->rotation[3];
    const double length = sqrt(x * x + y * y + z * z + w * w);

    if (length > 0.0 && isfinite(length)) {
        x /= length;
        y /= length;
        z /= length;
        w /= length;
    } else {
        x = y = z = 0.0;
        w = 1.0;
    }
    const double rotation[9] = {
        1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w),
        2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
        2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)
    };
    for (int row = 0; row < 3; row++) {
        for (int col = 0; col < 3; col++)
            out[row * 4 + col] = rotation[row * 3 + col] * node->scale[col];
        out[row * 4 + 3] = node->translation[row];
    }
}

static void local_matrix(const gltf_node *node, affine out)
{
    if (!node->has_matrix) {
        compose(node, out);
        return;
    }
    for (int row = 0; row < 3; row++) {
        for (int col = 0; col < 4; col++)
            out[row * 4 + col] = node->matrix[col * 4 + row];
    }
}

static void multiply(const affine a, const affine b, affine out)
{
    for (int row = 0; row < 3; row++) {
        for (int col = 0; col < 4; col++) {
            double sum = col == 3 ? a[row * 4 + 3] : 0.0;
            for (int k = 0; k < 3; k++)
                sum += a[row * 4 + k] * b[k * 4 + col];
            out[row * 4 + col] = sum;
        }
    }
}

typedef struct walk {
    const gltf_model *model;
    uint32_t *stack;
    size_t depth;
    affine *world; /* per node, valid once seen */
    bool *seen;
} walk;

/* A node with two parents or in a cycle is met twice: with the marks the walk
 * ends, and sharing cannot multiply the faces. */
static bool visit(walk *w, uint32_t node, const double *parent,
                  asset_error *error)
{
    affine local;

    if (w->seen[node])
        return asset_fail(error, "", "node %u is met twice: the nodes are not "
                          "a tree", (unsigned)node);
    w->seen[node] = true;
    local_matrix(&w->model->nodes[node], local);
    if (parent)
        multiply(parent, local, w->world[node]);
    else
        memcpy(w->world[node], local, sizeof local);
    w->stack[w->depth++] = node;
    return true;
}

static bool run(walk *w, gltf_instance *out, size_t *count,
                asset_error *error)
{
    const gltf_model *model = w->model;

    for (size_t i = model->root_count; i-- > 0;) {
        if (!visit(w, model->roots[i], NULL, error))
            return false;
    }
    while (w->depth > 0) {
        const uint32_t id = w->stack[--w->depth];
        const gltf_node *node = &model->nodes[id];
        if (node->mesh != GLTF_NONE) {
            memcpy(out[*count].m, w->world[id], sizeof out[*count].m);
            out[(*count)++].mesh = node->mesh;
        }
        for (size_t i = node->count; i-- > 0;) {
            if (!visit(w, model->children[node->first + i], w->world[id],
                       error))
                return false;
        }
    }
    return true;
}

bool gltf_scene_walk(const gltf_model *model, gltf_instance **out,
                     size_t *count, asset_error *error)
{
    const size_t n = model->node_count + 1; /* never 0 */
    walk w = { .model = model,
               .stack = calloc(n, sizeof *w.stack),
               .world = calloc(n, sizeof *w.world),
               .seen = calloc(n, sizeof *w.seen) };
    gltf_instance *instances = calloc(n, sizeof *instances);

    *count = 0;
    bool ok = w.stack && w.world && w.seen && instances;
    if (!ok)
        asset_fail(error, "", "out of memory");
    else
        ok = run(&w, instances, count, error);
    free(w.stack);
    free(w.world);
    free(w.seen);
    if (!ok) {
        free(instances);
        instances = NULL;
    }
    *out = instances;
    return ok;
}
