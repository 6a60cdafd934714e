/* SPDX-License-Identifier: MIT */
/*
 * reference FILE [FACES...] - decodes FILE as SPEC.md says and prints what is
 * to be seen at each number of faces (default: all that there are), as text.
 * Exits 0 if the file is complete, 1 if not, or if it is none.
 */
#include "tests/reference/ref.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

static void print_view(const ref *r, const ref_view *v)
{
    const int count = r->header.value_count;
    printf("view %" PRIu32 " faces %" PRIu32 " vertices %" PRIu32 " wedges\n",
           v->faces, v->vertices, v->wedges);
    for (uint32_t n = 0; n < v->vertices; n++)
        printf("vertex %" PRId32 " %" PRId32 " %" PRId32 " parent %" PRId32
               "\n",
               v->grid[3 * n], v->grid[3 * n + 1], v->grid[3 * n + 2],
               (int32_t)v->parents[n]);
    for (uint32_t w = 0; w < v->wedges; w++) {
        const float *p = v->positions + 3 * (size_t)w;
        printf("wedge of %" PRIu32 " at %a %a %a:", v->vertex_of[w],
               (double)p[0], (double)p[1], (double)p[2]);
        for (int i = 0; i < count; i++)
            printf(" %d", v->values[(size_t)count * w + (size_t)i]);
        printf("\n");
    }
    for (uint32_t f = 0; f < v->faces; f++)
        printf("face %" PRIu32 " %" PRIu32 " %" PRIu32 " material %" PRIu32
               "\n",
               v->indices[3 * f], v->indices[3 * f + 1],
               v->indices[3 * f + 2], v->materials[f]);
}

static uint8_t *read_file(const char *path, size_t *size)
{
    FILE *in = fopen(path, "rb");
    uint8_t *data = NULL;
    size_t room = 0, n;
    *size = 0;
    if (!in)
        return NULL;
    do {
        room = 2 * room + 65536;
        data = realloc(data, room);
        n = data ? fread(data + *size, 1, room - *size, in) : 0;
        *size += n;
    } while (n > 0 && *size == room);
    fclose(in);
    return data;
}

int main(int argc, char **argv)
{
    static const char *const verdicts[] = { "complete", "incomplete",
                                            "rejected", "of a newer version",
                                            "unsupported" };
    size_t size;
    uint8_t *data = argc > 1 ? read_file(argv[1], &size) : NULL;
    if (!data) {
        fprintf(stderr, "usage: reference FILE [FACES...]\n");
        return 2;
    }
    ref *r = ref_decode(data, size);
    const ref_verdict verdict = r->verdict;
    printf("%s%s%s\n", verdicts[verdict], *r->rule ? ": SPEC " : "", r->rule);
    if (verdict == REF_COMPLETE || verdict == REF_INCOMPLETE)
        for (int i = 2; r->has_base && i <= (argc > 2 ? argc - 1 : 2); i++) {
            ref_view v = ref_view_at(
                r, argc > 2 ? strtoull(argv[i], NULL, 10) : UINT64_MAX);
            print_view(r, &v);
            ref_view_free(&v);
        }
    ref_free(r);
    free(data);
    return verdict != REF_COMPLETE;
}
