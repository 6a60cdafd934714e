/* SPDX-License-Identifier: MIT */
/*
 * Usage: train MESH...
 *
 * Prints format/tables.c: where the models of a stream start. Every mesh is
 * coded in every profile from the tables so far; what the models have become
 * in the end, averaged over all, are the next tables. A model that a mesh did
 * not use does not count. A few rounds of this settle.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "encoder/enc_replay.h"
#include "format/alloc.h"
#include "tools/load.h"

enum {
    RESIDUAL_BITS = PMESH_SCALES * PMESH_RESIDUAL_BITS,
    ROUNDS = 3,
    BLOCK_SPLITS = 30000,
    ROOM = 1 << 22
};

#define COUNT(array) (sizeof(array) / sizeof((array)[0]))

typedef struct sums {
    double value, weight;
} sums;

/* One average for each number of the tables. */
typedef struct totals {
    sums cut[sizeof(pmesh_cut_weights) / sizeof(int32_t)];
    sums predict[PMESH_PREDICT_KINDS][PMESH_PREDICT_CLASSES][3][2]
                [PMESH_FIT_TERMS];
    sums flag[PMESH_FLAG_CONTEXTS];
    sums rank[2 * PMESH_CUT_RANKS * PMESH_CUT_ODDS];
    sums any[RESIDUAL_BITS];
    sums low[PMESH_SCALES * 3];
    sums along[2][PMESH_PREDICT_CLASSES * 3 * PMESH_IRREGULAR];
    sums across[2][PMESH_ROUGH * 3];
} totals;

static void add(sums *s, double value, double weight)
{
    s->value += weight * value;
    s->weight += weight;
}

/* Odds are averaged by their logarithm. */
static void add_bits(sums *s, const pmesh_bit *bits, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const double p = (pmesh_bit_odds(&bits[i]) + 1) / 65538.0;
        add(&s[i], log(p / (1 - p)), pmesh_bit_uses(&bits[i]));
    }
}

static void add_means(sums *s, const pmesh_mean *means, size_t count)
{
    for (size_t i = 0; i < count; i++)
        add(&s[i], log(means[i].value + 1.0), means[i].uses);
}

static void add_place(totals *t, const pmesh_place_models *m,
                      pmesh_predict_kind kind)
{
    const int which = kind == PMESH_PREDICT_MOVED_PARENT;
    const pmesh_residual_model *r = &m->residual;
    const pmesh_fit *fit = &m->predict[0][0][0];
    sums *s = &t->predict[kind][0][0][0][0];
    for (size_t i = 0; i < sizeof m->predict / sizeof *fit; i++)
        for (int k = 0; k < PMESH_FIT_TERMS; k++)
            add(s++, fit[i].weight[k], fit[i].count < 500 ? fit[i].count : 500);
    add_bits(t->any, (const pmesh_bit *)r->any, RESIDUAL_BITS);
    add_bits(t->low, r->low[0], PMESH_SCALES * 3);
    add_means(t->along[which], &m->along[0][0][0], COUNT(t->along[0]));
    add_means(t->across[which], &m->across[0][0], COUNT(t->across[0]));
}

static void add_models(totals *t, const pmesh_models *m)
{
    const int32_t *cut = (const int32_t *)&m->cut_weights;
    for (size_t i = 0; i < sizeof t->cut / sizeof *t->cut; i++)
        add(&t->cut[i], cut[i], 1);
    add_bits(t->flag, m->flag, PMESH_FLAG_CONTEXTS);
    add_bits(t->rank, m->cut[0][0], sizeof m->cut / sizeof(pmesh_bit));
}

/* ---- tables from averages ------------------------------------------------ */

static int32_t rounded(double x, double least, double most)
{
    return (int32_t)lrint(x < least ? least : x > most ? most : x);
}

static void set_words(int16_t *to, const sums *s, size_t count, double unit)
{
    for (size_t i = 0; i < count; i++)
        if (s[i].weight > 0)
            to[i] = (int16_t)rounded(s[i].value / s[i].weight / unit, -32767,
                                     32767);
}

/* Probabilities of a 0 in 1/256; 0 where little was seen. */
static void set_bits(uint8_t *to, const sums *s, size_t count)
{
    enum { LEAST_USES = 8 };
    for (size_t i = 0; i < count; i++) {
        const double p = s[i].weight < LEAST_USES
                             ? 0
                             : 256 / (1 + exp(-s[i].value / s[i].weight)) - 0.5;
        to[i] = (uint8_t)(p > 0 ? rounded(p, 1, 255) : 0);
    }
}

static void set_means(uint16_t *to, const sums *s, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (s[i].weight > 0)
            to[i] = (uint16_t)rounded(exp(s[i].value / s[i].weight), 1, 65535);
}

static void set_predict(int16_t *to, const totals *t)
{
    const sums(*from)[2][PMESH_FIT_TERMS] = t->predict[0][0];
    for (size_t i = 0; i < sizeof t->predict / sizeof *from; i++)
        for (int k = 0; k < PMESH_FIT_TERMS; k++)
            for (int side = 0; side < 2; side++)
                set_words(to++, &from[i][side][k], 1, 256);
}

static void set_tables(pmesh_tables *to, const totals *t)
{
    const sums *from = t->cut; /* in the order of pmesh_cut_weights */
    set_words(to->shape, from, COUNT(to->shape), 4);
    from += COUNT(to->shape);
    set_words(to->reach, from, COUNT(to->reach), 4);
    from += COUNT(to->reach);
    set_words(to->degree, from, COUNT(to->degree), 256);
    from += COUNT(to->degree);
    set_words(to->state, from, COUNT(to->state), 256);
    from += COUNT(to->state);
    set_words(to->span, from, COUNT(to->span), 256);
    set_predict(to->predict, t);
    set_bits(to->flag, t->flag, PMESH_FLAG_CONTEXTS);
    set_bits(to->rank, t->rank, COUNT(to->rank));
    set_bits(to->residual, t->any, COUNT(to->residual));
    set_bits(to->low, t->low, COUNT(to->low));
    set_means(to->along, t->along[0], COUNT(to->along));
    set_means(to->across, t->across[0], COUNT(to->across));
}

/* ---- coding ---------------------------------------------------------------
 */

static pmesh_status code(enc_replay *r, const pmesh_encoder_config *config,
                         const enc_schedule *schedule, uint8_t *room)
{
    pmesh_writer out = { room, 0, ROOM, false };
    pmesh_status status = enc_replay_base(r, config, &out);
    for (uint32_t b = schedule->batch_count; b-- > 0 && status == PMESH_OK;) {
        enc_replay_begin(r, b);
        while (r->splits_left && status == PMESH_OK) {
            pmesh_coder coder;
            out.size = 0;
            pmesh_coder_encode(&coder, &out);
            status = enc_replay_block(
                r, &coder,
                r->splits_left < BLOCK_SPLITS ? r->splits_left : BLOCK_SPLITS);
        }
    }
    return status;
}

static pmesh_status run(const pmesh_mesh_input *in,
                        const pmesh_encoder_config *config,
                        const pmesh_tables *start, totals *sum, uint8_t *room)
{
    pmesh_encode_report report = { 0 };
    enc_mesh mesh;
    enc_schedule schedule;
    enc_replay replay;
    pmesh_status status = enc_mesh_import(in, config, NULL, &mesh, &report);
    if (status != PMESH_OK)
        return status;
    status = enc_schedule_build(&mesh, config, 0, &schedule);
    if (status != PMESH_OK)
        return status;
    status = enc_replay_create(&replay, &mesh, &schedule,
                               config->placement == PMESH_OPTIMAL);
    if (status != PMESH_OK)
        return status;
    pmesh_codec_start(&replay.codec, start);
    status = code(&replay, config, &schedule, room);
    add_models(sum, &replay.codec.models);
    if (replay.moves)
        add_place(sum, &replay.codec.place[1], PMESH_PREDICT_MOVED_PARENT);
    add_place(sum, &replay.codec.place[0],
              replay.moves ? PMESH_PREDICT_MOVED_CHILD : PMESH_PREDICT_CHILD);
    enc_replay_destroy(&replay);
    enc_schedule_destroy(&schedule);
    enc_mesh_destroy(&mesh);
    return status;
}

static void train_on(const char *path, const pmesh_tables *start, totals *sum,
                     uint8_t *room)
{
    static const int depths[] = { 12, 14 };
    asset a;
    asset_error error;
    if (load_mesh(path, &a, &error) != 0) {
        fprintf(stderr, "train: %s: %s %s\n", path, error.where, error.what);
        exit(1);
    }
    const pmesh_mesh_input in = { .positions = a.positions,
                                  .vertex_count = a.vertex_count,
                                  .indices = a.indices,
                                  .face_count = a.face_count };
    for (int depth = 0; depth < 2; depth++)
        for (int profile = 0; profile < 4; profile++) {
            pmesh_encoder_config config = pmesh_encoder_config_default();
            config.allocator = pmesh_allocator_resolve(config.allocator);
            config.position_bits = (uint8_t)depths[depth];
            config.profile = (pmesh_profile)(profile < 3 ? profile : 2);
            config.placement = profile < 3 ? PMESH_SUBSET : PMESH_OPTIMAL;
            if (run(&in, &config, start, sum, room) != PMESH_OK)
                exit(1);
        }
    asset_free(&a);
}

/* ---- printing --------------------------------------------------------------
 */

static void print_numbers(const char *name, const void *numbers, size_t count,
                          int kind)
{
    int column = 0;
    printf("    .%s = {", name);
    for (size_t i = 0; i < count; i++) {
        char text[16];
        const int value = kind == 'w'   ? ((const int16_t *)numbers)[i]
                          : kind == 'm' ? ((const uint16_t *)numbers)[i]
                                        : ((const uint8_t *)numbers)[i];
        const int length = snprintf(text, sizeof text, " %d,", value);
        if (column == 0 || column + length > 79)
            column = printf("\n       ") - 1;
        column += printf("%s", text);
    }
    printf("\n    },\n");
}

#define PRINT(field, kind)                                                     \
    print_numbers(#field, t->field, COUNT(t->field), kind)

static void print_tables(const pmesh_tables *t)
{
    printf("/* SPDX-License-Identifier: MIT */\n"
           "#include \"format/tables.h\"\n\n"
           "const pmesh_tables pmesh_start = {\n");
    PRINT(shape, 'w');
    PRINT(reach, 'w');
    PRINT(degree, 'w');
    PRINT(state, 'w');
    PRINT(span, 'w');
    PRINT(predict, 'w');
    PRINT(along, 'm');
    PRINT(across, 'm');
    PRINT(flag, 'b');
    PRINT(rank, 'b');
    PRINT(residual, 'b');
    PRINT(low, 'b');
    printf("};\n");
}

int main(int argc, char **argv)
{
    static pmesh_tables now;
    static totals sum;
    uint8_t *room = malloc(ROOM);
    if (argc < 2 || !room) {
        fprintf(stderr, "usage: train MESH...\n");
        return 2;
    }
    now = pmesh_start;
    for (int round = 0; round < ROUNDS; round++) {
        memset(&sum, 0, sizeof sum);
        for (int i = 1; i < argc; i++) {
            fprintf(stderr, "round %d: %s\n", round + 1, argv[i]);
            train_on(argv[i], &now, &sum, room);
        }
        set_tables(&now, &sum);
    }
    print_tables(&now);
    free(room);
    return 0;
}
