/* SPDX-License-Identifier: MIT */
/* What `pmesh verify` calls good `pmesh extract` can show: every face, in a file
 * that is read again. With Draco itself, as the program has it. */
#include <stdlib.h>

#include "tests/fuzz/import.h"
#include "tools/cmd.h"
#include "tools/load.h"
#include "tools/scene_file.h"
#include "tools/stream.h"

enum { SMALL = 20000 };

static void extract(const file_data *data, uint32_t faces)
{
    asset mesh, back;
    asset_error error;
    asset_bytes out = { 0 };

    FUZZ_CHECK(load_mesh_data(data, "x.pmesh", &mesh, &error) == CMD_DONE);
    FUZZ_CHECK(mesh.face_count == faces);
    fuzz_asset_sound(&mesh);
    if (faces < SMALL) {
        FUZZ_CHECK(asset_write(&mesh, ASSET_OBJ, &out, &error));
        FUZZ_CHECK(asset_read(out.data, out.size, ASSET_OBJ, NULL, &back,
                              &error));
        FUZZ_CHECK(back.face_count == faces);
        asset_free(&back);
    }
    asset_bytes_free(&out);
    asset_free(&mesh);
}

static void verify(const file_data *data)
{
    asset_error error;
    stream s;
    const int code = stream_open(data, &s, &error);

    if (s.decoder)
        fuzz_sound(s.decoder);
    if (code != CMD_DONE)
        fuzz_error_sound(&error);
    else if (s.progress.complete)
        extract(data, s.header.faces);
    stream_close(&s);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    file_data data = { .bytes = fuzz_copy(bytes, size), .size = size };
    uint8_t *owned = data.bytes;
    if (!scene_file_is(&data))
        verify(&data);
    free(owned);
    return 0;
}
