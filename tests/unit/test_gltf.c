/* SPDX-License-Identifier: MIT */
/* glTF, GLB and Draco: readers on good and hostile bytes, writers by reading
 * back. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <meshoptimizer.h>

#include "tests/unit/test.h"
#include "tools/asset.h"

/* Members of a document around one mesh with the vertices of a unit square:
 * POSITION is accessor 0, bytes 0..47; indices follow. */
#define ASSET "\"asset\":{\"version\":\"2.0\"}"
#define SCENE "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}]"
#define MESH                                                            \
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},"    \
    "\"indices\":1}]}]"
#define ACCESSORS                                                       \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"          \
    "\"count\":4,\"type\":\"VEC3\"},{\"bufferView\":1,"                 \
    "\"componentType\":5121,\"count\":6,\"type\":\"SCALAR\"}]"
#define VIEWS                                                           \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},"                \
    "{\"buffer\":0,\"byteOffset\":48,\"byteLength\":6}]"
#define BUFFERS "\"buffers\":[{\"byteLength\":56}]"
#define SQUARE ASSET "," MESH "," ACCESSORS "," VIEWS "," BUFFERS

static const float square[12] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0 };

static void put_u32(uint8_t *p, size_t value)
{
    for (int i = 0; i < 4; i++)
        p[i] = (uint8_t)(value >> (8 * i));
}

static void put_floats(uint8_t *p, const float *v, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, v + i, sizeof bits);
        put_u32(p + 4 * i, bits);
    }
}

/* A GLB of the object members in `json`; malloc'ed. */
static uint8_t *make_glb(const char *json, const uint8_t *bin, size_t bin_size,
                         size_t *size)
{
    const size_t text = (strlen(json) + 2 + 3) / 4 * 4;
    const size_t body = (bin_size + 3) / 4 * 4;

    *size = 12 + 8 + text + 8 + body;
    uint8_t *glb = calloc(*size, 1);
    CHECK(glb);
    memcpy(glb, "glTF", 4);
    put_u32(glb + 4, 2);
    put_u32(glb + 8, *size);
    put_u32(glb + 12, text);
    memcpy(glb + 16, "JSON", 4);
    memset(glb + 20, ' ', text);
    glb[20] = '{';
    memcpy(glb + 21, json, strlen(json));
    glb[21 + strlen(json)] = '}';
    put_u32(glb + 20 + text, body);
    memcpy(glb + 24 + text, "BIN\0", 4);
    memcpy(glb + 28 + text, bin, bin_size);
    return glb;
}

static void square_bin(uint8_t bin[56])
{
    static const uint8_t indices[8] = { 0, 1, 2, 2, 1, 3, 0, 0 };
    put_floats(bin, square, 12);
    memcpy(bin + 48, indices, sizeof indices);
}

static bool read_glb(const char *json, const uint8_t *bin, size_t bin_size,
                     asset *out, asset_error *error)
{
    size_t size;
    uint8_t *glb = make_glb(json, bin, bin_size, &size);
    const bool ok = asset_read_gltf(glb, size, NULL, out, error);
    free(glb);
    return ok;
}

static bool read_square(const char *json, asset *out, asset_error *error)
{
    uint8_t bin[56];
    square_bin(bin);
    return read_glb(json, bin, sizeof bin, out, error);
}

/* Whether reading fails, cleanly, with `word` in the message. */
static bool refuses(const char *json, const char *word)
{
    asset mesh;
    asset_error error = { "", "" };
    if (read_square(json, &mesh, &error)) {
        asset_free(&mesh);
        return false;
    }
    return mesh.positions == NULL && strstr(error.what, word) != NULL;
}

static const double *corner(const asset *mesh, size_t i)
{
    return mesh->positions + 3 * (size_t)mesh->indices[i];
}

static double face_normal_z(const asset *mesh, size_t face)
{
    const double *a = corner(mesh, 3 * face), *b = corner(mesh, 3 * face + 1);
    const double *c = corner(mesh, 3 * face + 2);
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

TEST(gltf_reads_an_indexed_mesh)
{
    asset mesh;
    asset_error error;
    CHECK(read_square(SQUARE "," SCENE, &mesh, &error));
    CHECK(mesh.face_count == 2 && mesh.vertex_count == 4);
    CHECK(corner(&mesh, 5)[0] == 1.0 && corner(&mesh, 5)[1] == 1.0);
    CHECK(face_normal_z(&mesh, 0) > 0 && face_normal_z(&mesh, 1) > 0);
    CHECK(mesh.attribute_count == 0 && mesh.warnings[0] == '\0');
    asset_free(&mesh);
}

TEST(gltf_refuses_every_proper_prefix)
{
    uint8_t bin[56];
    size_t size;
    square_bin(bin);
    uint8_t *glb = make_glb(SQUARE "," SCENE, bin, sizeof bin, &size);

    for (size_t n = 0; n < size; n++) {
        asset mesh;
        asset_error error;
        uint8_t *cut = malloc(n > 0 ? n : 1); /* exact, for ASan */
        CHECK(cut);
        memcpy(cut, glb, n);
        CHECK(!asset_read_gltf(cut, n, NULL, &mesh, &error));
        CHECK(error.what[0] != '\0');
        free(cut);
    }
    free(glb);
}

TEST(gltf_keeps_fronts_in_front_when_a_node_mirrors)
{
    asset mesh;
    asset_error error;
    CHECK(read_square(SQUARE ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":["
                      "{\"children\":[1],\"scale\":[2,2,2]},"
                      "{\"mesh\":0,\"scale\":[-1,1,1],"
                      "\"translation\":[5,0,0]}]", &mesh, &error));
    CHECK(mesh.face_count == 2);
    CHECK(face_normal_z(&mesh, 0) > 0 && face_normal_z(&mesh, 1) > 0);
    CHECK(corner(&mesh, 0)[0] == 10.0);
    asset_free(&mesh);
}

TEST(gltf_turns_strips_and_fans_into_triangles)
{
    static const char *const modes[] = { "5", "6" };
    for (int i = 0; i < 2; i++) {
        asset mesh;
        asset_error error;
        char json[1024];
        snprintf(json, sizeof json,
                 ASSET "," SCENE "," ACCESSORS "," VIEWS "," BUFFERS
                 ",\"meshes\":[{\"primitives\":[{\"mode\":%s,"
                 "\"attributes\":{\"POSITION\":0}}]}]", modes[i]);
        CHECK(read_square(json, &mesh, &error));
        CHECK(mesh.face_count == 2);
        CHECK(face_normal_z(&mesh, 0) > 0);
        CHECK(i == 1 || face_normal_z(&mesh, 1) > 0);
        asset_free(&mesh);
    }
}

TEST(gltf_refuses_bad_indices)
{
    asset mesh;
    asset_error error;
    uint8_t bin[56];

    square_bin(bin);
    bin[50] = 4; /* of vertices 0..3 */
    CHECK(!read_glb(SQUARE "," SCENE, bin, sizeof bin, &mesh, &error));
    CHECK(strstr(error.what, "out of range"));
    bin[50] = 255;
    CHECK(!read_glb(SQUARE "," SCENE, bin, sizeof bin, &mesh, &error));
    CHECK(strstr(error.what, "restart"));
}

TEST(gltf_refuses_a_position_that_is_not_finite)
{
    asset mesh;
    asset_error error;
    uint8_t bin[56];

    square_bin(bin);
    put_u32(bin + 12, 0x7FC00000u);
    CHECK(!read_glb(SQUARE "," SCENE, bin, sizeof bin, &mesh, &error));
    CHECK(strstr(error.what, "not finite"));
}

TEST(gltf_reads_sparse_and_normalised_positions)
{
    /* Four zero vertices; 1 and 2 are replaced; 16-bit, normalised. */
    static const char json[] = ASSET "," SCENE "," MESH
        ",\"accessors\":[{\"componentType\":5122,\"normalized\":true,"
        "\"count\":4,\"type\":\"VEC3\",\"sparse\":{\"count\":2,"
        "\"indices\":{\"bufferView\":0,\"componentType\":5121},"
        "\"values\":{\"bufferView\":1}}},{\"bufferView\":2,"
        "\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":2},"
        "{\"buffer\":0,\"byteOffset\":4,\"byteLength\":12},"
        "{\"buffer\":0,\"byteOffset\":16,\"byteLength\":3}],"
        "\"buffers\":[{\"byteLength\":20}]";
    static const uint8_t bin[20] = {
        1, 2, 0, 0, /* elements */
        0xFF, 0x7F, 0, 0, 0, 0, 0, 0, 0x01, 0x80, 0, 0,
        0, 1, 2, 0
    };
    asset mesh;
    asset_error error;
    CHECK(read_glb(json, bin, sizeof bin, &mesh, &error));
    CHECK(mesh.face_count == 1 && mesh.vertex_count == 3);
    CHECK(corner(&mesh, 0)[0] == 0.0);
    CHECK(corner(&mesh, 1)[0] == 1.0 && corner(&mesh, 2)[1] == -1.0);
    asset_free(&mesh);
}

TEST(gltf_names_what_it_does_not_support)
{
    CHECK(refuses(SQUARE "," SCENE ",\"extensionsRequired\":[\"ACME_mesh\"]",
                  "ACME_mesh"));
    CHECK(refuses(SQUARE "," SCENE
                  ",\"extensionsRequired\":[\"KHR_meshopt_compression\"]",
                  "KHR_meshopt_compression"));
    CHECK(refuses("\"asset\":{\"version\":\"1.0\"}", "1.0"));
    CHECK(refuses("\"asset\":{\"version\":\"2.0\",\"minVersion\":\"2.1\"}",
                  "2.1"));
    CHECK(refuses(ASSET, "no triangles"));
}

TEST(gltf_refuses_nodes_that_are_no_tree)
{
    CHECK(refuses(SQUARE ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":["
                  "{\"mesh\":0,\"children\":[1]},{\"children\":[0]}]",
                  "not a tree"));
    CHECK(refuses(SQUARE ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":["
                  "{\"children\":[1,1]},{\"mesh\":0}]", "not a tree"));
    CHECK(refuses(SQUARE ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":["
                  "{\"mesh\":0,\"children\":[7]}]", "7"));
}

TEST(gltf_refuses_deep_json)
{
    char json[700] = SQUARE "," SCENE ",\"extras\":";
    size_t n = strlen(json);
    CHECK(n + 140 < sizeof json);
    for (size_t i = 0; i < 70; i++) {
        json[n + i] = '[';
        json[n + 70 + i] = ']';
    }
    CHECK(refuses(json, "nested"));
}

TEST(gltf_does_not_leave_the_assets_folder)
{
    static const char *const uris[] = {
        "../x.bin", "a/../../x.bin", "/etc/passwd", "file:///etc/passwd",
        "http://127.0.0.1:9/x", "%2e%2e/x.bin", "%2Fetc%2Fpasswd", "..\\\\x",
        "", "a%00b"
    };
    for (size_t i = 0; i < sizeof uris / sizeof *uris; i++) {
        asset mesh;
        asset_error error;
        char json[1024];
        snprintf(json, sizeof json,
                 "{" ASSET "," SCENE "," MESH "," ACCESSORS "," VIEWS
                 ",\"buffers\":[{\"byteLength\":56,\"uri\":\"%s\"}]}",
                 uris[i]);
        CHECK(!asset_read_gltf((const uint8_t *)json, strlen(json),
                               "folder/x.gltf", &mesh, &error));
        CHECK(strstr(error.what, "outside") || strstr(error.what, "scheme") ||
              strstr(error.what, "empty"));
    }
}

TEST(gltf_expands_meshopt_views)
{
    static const char form[] = ASSET "," SCENE "," MESH "," ACCESSORS
        ",\"extensionsRequired\":[\"EXT_meshopt_compression\"],"
        "\"bufferViews\":[{\"buffer\":1,\"byteLength\":48,\"extensions\":"
        "{\"EXT_meshopt_compression\":{\"buffer\":0,\"byteLength\":%zu,"
        "\"byteStride\":12,\"count\":%s,\"mode\":\"ATTRIBUTES\"}}},"
        "{\"buffer\":0,\"byteOffset\":%zu,\"byteLength\":6}],"
        "\"buffers\":[{\"byteLength\":%zu},{\"byteLength\":48}]";
    uint8_t raw[56], bin[512];
    char json[1500];
    asset mesh;
    asset_error error;

    square_bin(raw);
    const size_t n = meshopt_encodeVertexBuffer(bin, 400, raw, 4, 12);
    CHECK(n > 0);
    memcpy(bin + n, raw + 48, 6);
    snprintf(json, sizeof json, form, n, "4", n, n + 6);
    CHECK(read_glb(json, bin, n + 6, &mesh, &error));
    CHECK(mesh.face_count == 2 && corner(&mesh, 1)[0] == 1.0);
    asset_free(&mesh);

    snprintf(json, sizeof json, form, n, "4000000000", n, n + 6);
    CHECK(!read_glb(json, bin, n + 6, &mesh, &error));
    snprintf(json, sizeof json, form, n - 5, "4", n, n + 6);
    CHECK(!read_glb(json, bin, n + 6, &mesh, &error));
    CHECK(strstr(error.what, "meshopt"));
}

/* ---- writers ------------------------------------------------------------ */

#define GRID 20

/* A wavy sheet about `origin` with normals per vertex, UVs per corner, colours
 * and two materials; asset_free() releases it. */
static asset make_sheet(double origin)
{
    asset m = { .vertex_count = GRID * GRID,
                .face_count = 2 * (GRID - 1) * (GRID - 1),
                .material_count = 2, .attribute_count = 3 };
    const size_t corners = m.face_count * 3;
    m.positions = malloc(m.vertex_count * 3 * sizeof *m.positions);
    m.indices = malloc(corners * sizeof *m.indices);
    m.materials = calloc(m.face_count, sizeof *m.materials);
    m.material_names = calloc(2, sizeof *m.material_names);
    CHECK(m.positions && m.indices && m.materials && m.material_names);
    static const uint8_t components[3] = { 3, 2, 4 };
    for (size_t i = 0; i < 3; i++) {
        asset_attribute *a = &m.attributes[i];
        a->kind = (pmesh_attribute_kind)i;
        a->components = components[i];
        a->count = i == 1 ? 2 * m.vertex_count : m.vertex_count;
        a->values = calloc(a->count * a->components, sizeof *a->values);
        CHECK(a->values);
    }
    for (uint32_t i = 0; i < m.vertex_count; i++) {
        const uint32_t x = i % GRID, y = i / GRID;
        double *p = m.positions + 3 * i;
        p[0] = origin + x;
        p[1] = origin + y;
        p[2] = origin + 0.25 * ((x + y) % 3);
        m.attributes[0].values[3 * i + 2] = 1.0f;
        m.attributes[1].values[2 * i] = (float)x / GRID;
        m.attributes[1].values[2 * (i + m.vertex_count)] = 0.5f;
        m.attributes[2].values[4 * i] = (float)x / GRID;
        m.attributes[2].values[4 * i + 3] = 1.0f;
    }
    size_t n = 0;
    for (uint32_t y = 0; y + 1 < GRID; y++) {
        for (uint32_t x = 0; x + 1 < GRID; x++) {
            const uint32_t a = y * GRID + x;
            const uint32_t faces[6] = { a, a + 1, a + GRID,
                                        a + GRID, a + 1, a + GRID + 1 };
            memcpy(m.indices + n, faces, sizeof faces);
            n += 6;
        }
    }
    uint32_t *seam = malloc(corners * sizeof *seam);
    CHECK(seam);
    for (size_t i = 0; i < corners; i++) {
        const bool upper = i >= corners / 2;
        seam[i] = m.indices[i] + (upper ? (uint32_t)m.vertex_count : 0);
        m.materials[i / 3] = upper;
    }
    m.attributes[1].indices = seam;
    static const char *const names[2] = { "a \"quoted\" name", "second" };
    for (size_t i = 0; i < 2; i++) {
        m.material_names[i] = malloc(strlen(names[i]) + 1);
        CHECK(m.material_names[i]);
        memcpy(m.material_names[i], names[i], strlen(names[i]) + 1);
    }
    return m;
}

static asset write_and_read(const asset *mesh, asset_format format)
{
    asset_bytes bytes = { 0 };
    asset_error error;
    asset back;

    if (format == ASSET_DRC) {
        CHECK(asset_write_drc(mesh, &bytes, &error));
        CHECK(asset_read_drc(bytes.data, bytes.size, &back, &error));
    } else {
        CHECK(asset_write_gltf(mesh, format == ASSET_GLB, &bytes, &error));
        CHECK(asset_read_gltf(bytes.data, bytes.size, NULL, &back, &error));
    }
    CHECK(back.warnings[0] == '\0');
    asset_bytes_free(&bytes);
    return back;
}

TEST(gltf_writes_what_it_reads)
{
    static const asset_format formats[] = { ASSET_GLB, ASSET_GLTF };
    for (int i = 0; i < 2; i++) {
        asset mesh = make_sheet(0.0);
        asset back = write_and_read(&mesh, formats[i]);

        CHECK(back.face_count == mesh.face_count);
        CHECK(back.attribute_count == 3 && back.material_count == 2);
        CHECK(!strcmp(back.material_names[0], mesh.material_names[0]));
        CHECK(!strcmp(back.material_names[1], "second"));
        const asset_attribute *uv = &mesh.attributes[1];
        for (size_t c = 0; c < mesh.face_count * 3; c++) {
            for (int k = 0; k < 3; k++)
                CHECK(corner(&back, c)[k] == corner(&mesh, c)[k]);
            CHECK(back.materials[c / 3] == mesh.materials[c / 3]);
            CHECK(back.attributes[1].values[2 * back.indices[c]] ==
                  uv->values[2 * uv->indices[c]]);
            CHECK(back.attributes[2].values[4 * back.indices[c]] ==
                  mesh.attributes[2].values[4 * mesh.indices[c]]);
        }
        asset_free(&back);
        asset_free(&mesh);
    }
}

TEST(gltf_keeps_precision_far_from_the_origin)
{
    asset mesh = make_sheet(4e6 + 0.125);
    asset back = write_and_read(&mesh, ASSET_GLB);
    for (size_t c = 0; c < mesh.face_count * 3; c++) {
        for (int k = 0; k < 3; k++)
            CHECK(fabs(corner(&back, c)[k] - corner(&mesh, c)[k]) < 1e-5);
    }
    asset_free(&back);
    asset_free(&mesh);
}

TEST(drc_writes_what_it_reads)
{
    asset mesh = make_sheet(0.0);
    asset back = write_and_read(&mesh, ASSET_DRC);
    double sum[2] = { 0 };

    CHECK(back.face_count == mesh.face_count && back.attribute_count == 3);
    /* Draco reorders faces: compare what does not depend on the order. */
    for (size_t c = 0; c < mesh.face_count * 3; c++) {
        const double *a = corner(&mesh, c), *b = corner(&back, c);
        sum[0] += a[0] + 3 * a[1] + 7 * a[2] * a[0];
        sum[1] += b[0] + 3 * b[1] + 7 * b[2] * b[0];
    }
    CHECK(fabs(sum[0] - sum[1]) < 1e-4 * sum[0]);
    asset_free(&back);
    asset_free(&mesh);
}

TEST(drc_keeps_degenerate_faces)
{
    asset mesh = make_sheet(0.0);
    mesh.indices[1] = mesh.indices[0];
    asset back = write_and_read(&mesh, ASSET_DRC);
    CHECK(back.face_count == mesh.face_count);
    asset_free(&back);
    asset_free(&mesh);
}

TEST(drc_refuses_what_its_bytes_cannot_hold)
{
    /* Edgebreaker, 2.2: 2^28 points and faces in 40 bytes. */
    uint8_t bomb[40] = { 'D', 'R', 'A', 'C', 'O', 2, 2, 1, 1, 0, 0, 0,
                         0x80, 0x80, 0x80, 0x80, 1, 0x80, 0x80, 0x80, 0x80, 1 };
    asset mesh;
    asset_error error;
    CHECK(!asset_read_drc(bomb, sizeof bomb, &mesh, &error));
    CHECK(strstr(error.what, "claims"));
    bomb[7] = 0;
    CHECK(!asset_read_drc(bomb, sizeof bomb, &mesh, &error));
    CHECK(strstr(error.what, "no triangles"));
    CHECK(!asset_read_drc(bomb, 0, &mesh, &error));
}

/* Some counts of a stream Draco itself believes: such a one took 6 s, for bits
 * that are not there. */
TEST(drc_counts_that_lie_take_no_time)
{
    asset mesh = make_sheet(0.0), back;
    asset_bytes bytes = { 0 };
    asset_error error;
    uint32_t refused = 0;

    CHECK(asset_write_drc(&mesh, &bytes, &error));
    for (size_t at = 11; at + 4 <= bytes.size; at++) {
        uint8_t was[4];
        const clock_t from = clock();
        memcpy(was, bytes.data + at, 4);
        memcpy(bytes.data + at, "\xff\xff\xff\x7f", 4);
        if (asset_read_drc(bytes.data, bytes.size, &back, &error))
            asset_free(&back);
        else
            refused += strstr(error.what, "asks for more memory") != NULL;
        CHECK(clock() - from < 2 * CLOCKS_PER_SEC);
        memcpy(bytes.data + at, was, 4);
    }
    CHECK(refused > 0);
    asset_bytes_free(&bytes);
    asset_free(&mesh);
}

TEST(gltf_reads_draco_primitives)
{
    static const char form[] = ASSET "," SCENE
        ",\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,"
        "\"TEXCOORD_0\":2},\"indices\":1,\"extensions\":"
        "{\"KHR_draco_mesh_compression\":{\"bufferView\":0,"
        "\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":%d}}}}]}],"
        "\"accessors\":[{\"componentType\":5126,\"count\":400,"
        "\"type\":\"VEC3\"},{\"componentType\":5123,\"count\":2166,"
        "\"type\":\"SCALAR\"},{\"componentType\":5126,\"count\":400,"
        "\"type\":\"VEC2\"}],\"bufferViews\":[{\"buffer\":0,"
        "\"byteLength\":%zu}],\"buffers\":[{\"byteLength\":%zu}]";
    asset mesh = make_sheet(0.0), back;
    asset_bytes bytes = { 0 };
    asset_error error;
    char json[1500];

    CHECK(asset_write_drc(&mesh, &bytes, &error));
    snprintf(json, sizeof json, form, 2, bytes.size, bytes.size);
    CHECK(read_glb(json, bytes.data, bytes.size, &back, &error));
    CHECK(back.face_count == mesh.face_count && back.attribute_count == 1);
    CHECK(back.attributes[0].kind == PMESH_TEXCOORD);
    asset_free(&back);
    snprintf(json, sizeof json, form, 77, bytes.size, bytes.size);
    CHECK(!read_glb(json, bytes.data, bytes.size, &back, &error));
    CHECK(strstr(error.what, "77"));
    asset_bytes_free(&bytes);
    asset_free(&mesh);
}

/* ---- real models, where they are at hand -------------------------------- */

static uint8_t *load_model(const char *name, char path[512], size_t *size)
{
    const char *folder = getenv("PMESH_MODELS");
    snprintf(path, 512, "%s/%s", folder ? folder : "../shared/models", name);
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    CHECK(fseek(file, 0, SEEK_END) == 0);
    *size = (size_t)ftell(file);
    rewind(file);
    uint8_t *data = malloc(*size + 1);
    CHECK(data && fread(data, 1, *size, file) == *size);
    fclose(file);
    return data;
}

TEST(gltf_reads_real_models)
{
    static const struct {
        const char *name;
        size_t faces;
        uint32_t materials;
    } models[] = { { "CesiumMan.glb", 4672, 1 },
                   { "bridge-garden.glb", 21883, 13 },
                   { "FlightHelmet/FlightHelmet.gltf", 94722, 5 } };
    for (size_t i = 0; i < 3; i++) {
        char path[512];
        size_t size = 0;
        asset mesh;
        asset_error error;
        uint8_t *data = load_model(models[i].name, path, &size);
        if (!data)
            continue;
        CHECK(asset_read_gltf(data, size, path, &mesh, &error));
        free(data);
        CHECK(mesh.face_count == models[i].faces);
        CHECK(mesh.material_count == models[i].materials);
        asset back = write_and_read(&mesh, ASSET_GLB);
        CHECK(back.face_count == models[i].faces);
        asset_free(&back);
        asset_free(&mesh);
    }
}
