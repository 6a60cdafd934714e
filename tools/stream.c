/* SPDX-License-Identifier: MIT */
#include "tools/stream.h"

#include <stdio.h>
#include <string.h>

#include "tools/cmd.h"
#include "tools/draco_base.h"

/* A face costs the decoder some 100 bytes and the file at least 1/20 byte
 * where the surface is flat; a small file may still need the least. */
#define MEMORY_LEAST ((uint64_t)64 << 20)
#define MEMORY_PER_BYTE 16384u
#define MEMORY_MOST ((uint64_t)8 << 30)

#define HEADER_STEP 256u /* bytes fed at a time in search of the base's end */

uint64_t stream_memory(uint64_t size)
{
    if (size > (MEMORY_MOST - MEMORY_LEAST) / MEMORY_PER_BYTE)
        return MEMORY_MOST;
    return MEMORY_LEAST + MEMORY_PER_BYTE * size;
}

int stream_explain(const pmesh_decode_error *damage, uint64_t size,
                   asset_error *error)
{
    const pmesh_status status = damage->status;
    const bool ruled = damage->rule && *damage->rule;
    char where[48] = "";

    if (status == PMESH_E_MEMORY) {
        asset_fail(error, "", "out of memory");
        return CMD_IO;
    }
    if (status == PMESH_E_LIMIT) {
        asset_fail(error, "",
                   "needs more memory to decode than the %llu MiB allowed for "
                   "a file of %llu bytes",
                   (unsigned long long)(stream_memory(size) >> 20),
                   (unsigned long long)size);
        return CMD_STREAM;
    }
    if (status == PMESH_E_MAGIC) {
        asset_fail(error, "", "%s", pmesh_status_text(status));
        return CMD_STREAM;
    }
    snprintf(where, sizeof where, "byte %llu",
             (unsigned long long)damage->offset);
    asset_fail(error, where, "%s%s%s%s", pmesh_status_text(status),
               ruled ? " (" : "", ruled ? damage->rule : "", ruled ? ")" : "");
    return CMD_STREAM;
}

static int explain(const stream *s, uint64_t size, asset_error *error)
{
    const pmesh_decode_error damage = pmesh_decoder_error(s->decoder);
    return stream_explain(&damage, size, error);
}

static bool start(const file_data *data, stream *out, asset_error *error)
{
    pmesh_decoder_config config = pmesh_decoder_config_default();

    config.max_memory = stream_memory(data->size);
    config.base_decoder = draco_base_decode;
    *out = (stream){ 0 };
    const pmesh_status status = pmesh_decoder_create(&out->decoder, &config);
    if (status != PMESH_OK)
        return asset_fail(error, "", "%s", pmesh_status_text(status));
    return true;
}

static void look(stream *s)
{
    s->has_header = pmesh_decoder_header(s->decoder, &s->header) == PMESH_OK;
    s->progress = pmesh_decoder_progress(s->decoder);
}

int stream_open(const file_data *data, stream *out, asset_error *error)
{
    if (!start(data, out, error))
        return CMD_IO;
    const pmesh_status status =
        pmesh_decoder_feed(out->decoder, data->bytes, data->size);
    look(out);
    out->shown = pmesh_decoder_refine(out->decoder, NULL, NULL) == PMESH_OK;
    if (status < 0)
        return explain(out, data->size, error);
    return CMD_DONE;
}

int stream_open_header(const file_data *data, stream *out, asset_error *error)
{
    pmesh_status status = PMESH_NEED_DATA;
    size_t at = 0;

    if (!start(data, out, error))
        return CMD_IO;
    /* Names stand between the header and the base mesh. */
    while (status == PMESH_NEED_DATA && out->progress.levels == 0 &&
           at < data->size) {
        const size_t rest = data->size - at;
        const size_t size = rest < HEADER_STEP ? rest : HEADER_STEP;
        status = pmesh_decoder_feed(out->decoder, data->bytes + at, size);
        at += size;
        look(out);
    }
    if (out->has_header)
        return CMD_DONE; /* damage behind the header is not our question */
    if (status < 0)
        return explain(out, data->size, error);
    asset_fail(error, "", "cut off after %zu bytes, within the header",
               data->size);
    return CMD_STREAM;
}

void stream_close(stream *s)
{
    pmesh_decoder_destroy(s->decoder);
    *s = (stream){ 0 };
}
