/* SPDX-License-Identifier: MIT */
/*
 * upload.c - how an engine shows a mesh that sharpens while it loads. Draws
 * nothing: prints what it would send to the graphics card.
 *
 *   cc -I. upload.c pmesh_decode.c -o upload && ./upload bunny.pmesh 5000
 *
 * Buffers are made once, as large as the header says, and bound: after each
 * piece of the file the decoder writes what changed into them and names the
 * ranges to send again. The second argument is a budget of faces: reading
 * stops once it is met.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <pmesh_decode.h>

enum { PIECE = 16384 }; /* bytes that arrive at a time */

/* The memory behind two buffers of the graphics card, and what was sent. */
typedef struct buffers {
    pmesh_buffers bound;
    unsigned long vertices, faces; /* sent in all */
    unsigned uploads;
} buffers;

static int make_buffers(buffers *b, pmesh_decoder *dec, const pmesh_header *h)
{
    b->bound.index_size = h->vertices <= 65536 ? 2 : 4;
    b->bound.positions = (float *)malloc(12 * (size_t)h->vertices);
    b->bound.indices = malloc(3 * b->bound.index_size * (size_t)h->faces);
    printf("vertex buffer %lu bytes, index buffer %lu bytes\n",
           12ul * h->vertices, 3ul * b->bound.index_size * h->faces);
    return b->bound.positions && b->bound.indices &&
           pmesh_decoder_bind(dec, &b->bound) == PMESH_OK;
}

static void upload(buffers *b, const pmesh_changes *c)
{
    uint32_t i;

    for (i = 0; i < c->vertex_range_count; i++) {
        b->vertices += c->vertices[i].count;
        b->uploads++;
    }
    for (i = 0; i < c->face_range_count; i++) {
        b->faces += c->faces[i].count;
        b->uploads++;
    }
}

/* Shows what can be shown; true once the budget is met. */
static int show(pmesh_decoder *dec, buffers *b, uint32_t budget)
{
    pmesh_target target;
    pmesh_header header;
    pmesh_changes changes;
    pmesh_view view;

    if (pmesh_decoder_header(dec, &header) != PMESH_OK)
        return 0;
    if (!b->bound.positions && !make_buffers(b, dec, &header))
        return 1;
    memset(&target, 0, sizeof target); /* no limits */
    target.faces = budget;
    if (pmesh_decoder_refine(dec, &target, &changes) != PMESH_OK)
        return 0;
    upload(b, &changes);
    pmesh_decoder_mesh(dec, &view);
    printf("%7lu bytes: draw %6lu faces of %6lu vertices, error %.4g\n",
           (unsigned long)pmesh_decoder_progress(dec).bytes,
           (unsigned long)view.face_count, (unsigned long)view.vertex_count,
           (double)view.error);
    return budget > 0 && pmesh_decoder_progress(dec).faces > budget;
}

static int play(FILE *file, pmesh_decoder *dec, uint32_t budget)
{
    static unsigned char piece[PIECE];
    buffers b;
    pmesh_status status = PMESH_NEED_DATA;
    size_t size;

    memset(&b, 0, sizeof b);
    while (status == PMESH_NEED_DATA &&
           (size = fread(piece, 1, sizeof piece, file)) > 0) {
        status = pmesh_decoder_feed(dec, piece, size);
        if (show(dec, &b, budget))
            break;
    }
    printf("sent %lu vertices and %lu faces in %u uploads\n", b.vertices,
           b.faces, b.uploads);
    free(b.bound.positions);
    free(b.bound.indices);
    if (status < 0)
        fprintf(stderr, "byte %lu: %s\n",
                (unsigned long)pmesh_decoder_error(dec).offset,
                pmesh_decoder_error(dec).rule);
    return status < 0;
}

int main(int argc, char **argv)
{
    pmesh_decoder *dec;
    FILE *file = argc > 1 ? fopen(argv[1], "rb") : NULL;
    int failed;

    if (!file) {
        fprintf(stderr, "usage: upload FILE.pmesh [FACES]\n");
        return 2;
    }
    if (pmesh_decoder_create(&dec, NULL) != PMESH_OK) {
        fclose(file);
        return 1;
    }
    failed = play(file, dec, argc > 2 ? (uint32_t)atol(argv[2]) : 0);
    pmesh_decoder_destroy(dec);
    fclose(file);
    return failed;
}
