/* SPDX-License-Identifier: MIT */
/*
 * bench_refine.c - what it costs to move the visible mesh among the splits
 * that are decoded.
 *
 *   bench_refine FILE.pmesh... -> a line each: faces; faces/s up and down
 *   between base and full mesh, alone and with bound buffers; frames of 2 ms
 *   for the way up; bytes that ranges list against those that changed, on
 *   random walks and in steps of 1 % of the faces.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "decoder/pmesh_decode.h"

enum { WALKS = 20, FRAME_OPS = 8192, JUMPS = 200 };

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void *load(const char *path, size_t *size)
{
    FILE *in = fopen(path, "rb");
    uint8_t *data = NULL;
    if (in && fseek(in, 0, SEEK_END) == 0) {
        *size = (size_t)ftell(in);
        rewind(in);
        data = malloc(*size);
        if (data && fread(data, 1, *size, in) != *size)
            *size = 0;
    }
    if (in)
        fclose(in);
    return data;
}

/* Faces shown and hidden per second. */
static double walk(pmesh_decoder *dec, const pmesh_header *h)
{
    const pmesh_target base = { .faces = 1 };
    pmesh_changes c;
    const double start = now();
    for (int i = 0; i < WALKS; i++) {
        pmesh_decoder_refine(dec, &base, &c);
        pmesh_decoder_refine(dec, NULL, &c);
    }
    return 2.0 * WALKS * (h->faces - h->base_faces) / (now() - start);
}

/* The longest frame and the frames of FRAME_OPS splits from base to full. */
static double frames(pmesh_decoder *dec, unsigned *count)
{
    const pmesh_target base = { .faces = 1 };
    const pmesh_target up = { .max_ops = FRAME_OPS };
    pmesh_changes c;
    double worst = 0;
    pmesh_status status;
    pmesh_decoder_refine(dec, &base, NULL);
    *count = 0;
    do {
        const double start = now();
        status = pmesh_decoder_refine(dec, &up, &c);
        const double took = now() - start;
        worst = took > worst ? took : worst;
        ++*count;
    } while (status == PMESH_MORE);
    return worst;
}

/* Faces listed per face that changed; steps of `step` faces, 0: anywhere. */
static double excess(pmesh_decoder *dec, const pmesh_header *h, uint32_t step,
                     uint32_t *old)
{
    uint64_t listed = 0, changed = 0;
    uint32_t at = h->base_faces, seed = 1;
    for (int i = 0; i < JUMPS; i++) {
        pmesh_view v;
        pmesh_changes c;
        pmesh_decoder_mesh(dec, &v);
        const uint32_t before = v.face_count;
        memcpy(old, v.indices, 12 * (size_t)before);
        seed = seed * 1664525 + 1013904223;
        at = step ? at + step > h->faces ? h->base_faces : at + step
                  : 1 + seed / 4 % h->faces;
        pmesh_decoder_refine(dec, &(pmesh_target){ .faces = at }, &c);
        pmesh_decoder_mesh(dec, &v);
        for (uint32_t r = 0; r < c.face_range_count; r++)
            listed += c.faces[r].count;
        for (uint32_t f = 0; f < v.face_count; f++)
            changed += f >= before || memcmp(old + 3 * (size_t)f,
                                             v.indices + 3 * (size_t)f, 12);
    }
    return (double)listed / (double)changed;
}

static int measure(const char *path)
{
    size_t size = 0;
    pmesh_header h;
    pmesh_decoder *dec;
    unsigned count;
    uint8_t *data = load(path, &size);
    if (!data || pmesh_decoder_create(&dec, NULL) != PMESH_OK)
        return 1;
    const double start = now();
    if (pmesh_decoder_feed(dec, data, size) != PMESH_OK)
        return 1;
    const double fed = now() - start;
    pmesh_decoder_header(dec, &h);
    uint32_t *room = malloc(12 * (size_t)h.faces);
    pmesh_buffers b = { .indices = malloc(12 * (size_t)h.faces),
                        .positions = malloc(12 * (size_t)h.vertices) };
    if (!room || !b.indices || !b.positions)
        return 1;
    const double plain = walk(dec, &h);
    const double any = excess(dec, &h, 0, room);
    const double percent = excess(dec, &h, h.faces / 100, room);
    pmesh_decoder_bind(dec, &b);
    const double bound = walk(dec, &h);
    const double worst = frames(dec, &count);
    printf("%-12s %8lu faces: decode %.2f M faces/s, refine %.1f, bound %.1f; "
           "%u frames of %d splits, longest %.2f ms; listed / changed %.2f "
           "anywhere, %.2f by 1 %%\n", path, (unsigned long)h.faces,
           1e-6 * h.faces / fed, 1e-6 * plain, 1e-6 * bound, count, FRAME_OPS,
           1e3 * worst, any, percent);
    free(b.indices);
    free(b.positions);
    free(room);
    pmesh_decoder_destroy(dec);
    free(data);
    return 0;
}

int main(int argc, char **argv)
{
    int bad = argc < 2;
    for (int i = 1; i < argc; i++)
        bad |= measure(argv[i]);
    return bad;
}
