/* SPDX-License-Identifier: MIT */
/* glTF scenes taken apart and put together again: on documents that lie. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "encoder/pmesh_scene_encode.h"
#include "tests/unit/shapes.h"
#include "tests/unit/test.h"
#include "tools/pack.h"
#include "tools/scene_budget.h"
#include "tools/scene_parts.h"
#include "tools/scene_write.h"

static int collect(void *user, const void *data, size_t size)
{
    asset_put(user, data, size);
    return 0;
}

static const char resource[100000] = "0123456789";

/* A scene of one mesh with this document, of which the last bytes have not
 * arrived. */
static pmesh_scene *scene_of(shape_kind kind, uint32_t size,
                             pmesh_scene_blob document,
                             pmesh_document_form form, size_t missing)
{
    shape_mesh *shape = shape_make(kind, size, 1);
    const pmesh_encoder_config config = pmesh_encoder_config_default();
    pmesh_encode_report report;
    shape_bytes stream;
    asset_bytes file = { 0 };
    pmesh_scene *scene;

    CHECK(shape_bake(shape, &config, &stream, &report) == PMESH_OK);
    shape_free(shape);
    const pmesh_scene_mesh_input mesh = { stream.data, stream.size, 1 };
    const pmesh_scene_blob blob = { resource, sizeof resource };
    const pmesh_scene_input input = {
        .meshes = &mesh, .mesh_count = 1,
        .document = document, .document_form = form,
        .resources = &blob, .resource_count = 1
    };
    CHECK(pmesh_scene_encode(&input, NULL, collect, &file, NULL) == PMESH_OK);
    CHECK(pmesh_scene_create(&scene, NULL) == PMESH_OK);
    CHECK(pmesh_scene_feed(scene, file.data, file.size - missing) ==
          (missing > 0 ? PMESH_NEED_DATA : PMESH_OK));
    asset_bytes_free(&file);
    free(stream.data);
    return scene;
}

static pmesh_scene *scene_with(const char *document)
{
    return scene_of(SHAPE_TORUS, 8,
                    (pmesh_scene_blob){ document, strlen(document) },
                    PMESH_DOCUMENT_PLAIN, 0);
}

/* The same packed, and of a shape of our choice; frees the text. */
static pmesh_scene *scene_packed(shape_kind kind, uint32_t size,
                                 asset_bytes *text)
{
    asset_bytes packed = { 0 };
    CHECK(pack_zlib(text->data, text->size, &packed));
    pmesh_scene *scene =
        scene_of(kind, size, (pmesh_scene_blob){ packed.data, packed.size },
                 PMESH_DOCUMENT_ZLIB, 0);
    asset_bytes_free(&packed);
    asset_bytes_free(text);
    return scene;
}

/* Whether it is written as a .glb; if not, there is a message. */
static bool writes_as_glb(pmesh_scene *scene, scene_library *library)
{
    asset_bytes out = { 0 };
    asset notes = { 0 };
    asset_error error = { "", "" };
    const scene_style style = { .glb = true, .library = library };

    const bool ok = scene_write(scene, style, &out, &notes, &error);
    CHECK(ok || error.what[0] != '\0');
    asset_bytes_free(&out);
    return ok;
}

static bool writes(const char *document)
{
    pmesh_scene *scene = scene_with(document);
    const bool ok = writes_as_glb(scene, NULL);
    pmesh_scene_destroy(scene);
    return ok;
}

#define ASSET "\"asset\":{\"version\":\"2.0\"}"
#define PRIMITIVE(record)                                                  \
    "{" ASSET ",\"meshes\":[{\"primitives\":[{\"attributes\":{},"          \
    "\"extensions\":{\"PMESH_progressive\":" record "}}]}]}"
#define TORUS "{\"mesh\":0,\"material\":0,\"attributes\":{\"POSITION\":{}}}"

TEST(scene_is_written_by_its_document)
{
    CHECK(writes(PRIMITIVE(TORUS)));
}

TEST(scene_documents_that_lie_are_refused)
{
    static const char *const documents[] = {
        "", "{", "[]", "{}", "12", "{\"meshes\":3}", "{\"meshes\":[3]}",
        "{\"meshes\":[{\"primitives\":[[]]}],\"accessors\":{}}\x80",
        PRIMITIVE("{}"), PRIMITIVE("[]"), PRIMITIVE("null"),
        PRIMITIVE("{\"mesh\":1,\"material\":0,\"attributes\":{}}"),
        PRIMITIVE("{\"mesh\":-1,\"material\":0,\"attributes\":{}}"),
        PRIMITIVE("{\"mesh\":0,\"material\":1,\"attributes\":{}}"),
        PRIMITIVE("{\"mesh\":0,\"material\":4294967295,\"attributes\":{}}"),
        PRIMITIVE("{\"mesh\":0,\"material\":0,\"attributes\":{\"NORMAL\":"
                  "{\"channel\":0,\"type\":\"VEC3\"}}}"),
        PRIMITIVE("{\"mesh\":0,\"material\":0,\"attributes\":{\"NORMAL\":"
                  "{\"channel\":-7,\"type\":\"VEC3\"}}}"),
        PRIMITIVE("{\"mesh\":0,\"material\":0,\"attributes\":{\"NORMAL\":7}}"),
        "{" ASSET ",\"meshes\":[],\"bufferViews\":[{\"buffer\":1}]}",
        "{" ASSET ",\"meshes\":[],\"bufferViews\":[{\"buffer\":-1}]}",
        "{" ASSET ",\"meshes\":[],\"bufferViews\":[7]}",
        "{" ASSET ",\"meshes\":[],\"images\":[{\"bufferView\":5}]}",
        "{" ASSET ",\"meshes\":[],\"extensions\":{\"PMESH_progressive\":"
        "{\"accessors\":[0]}}}",
        "{" ASSET ",\"meshes\":[],\"extensions\":{\"PMESH_progressive\":7}}"
    };
    for (size_t i = 0; i < sizeof documents / sizeof *documents; i++)
        CHECK(!writes(documents[i]));
}

/* Conversions of such numbers are undefined, or take them for others. */
TEST(scene_documents_with_numbers_that_are_none_are_refused)
{
    static const char *const numbers[] = { "1e300", "-1", "-1e300", "0.5",
                                           "4294967296", "9007199254740994",
                                           "18446744073709551615", "null" };
    static const char *const documents[] = {
        PRIMITIVE("{\"mesh\":%s,\"material\":0,\"attributes\":{}}"),
        PRIMITIVE("{\"mesh\":0,\"material\":%s,\"attributes\":{}}"),
        PRIMITIVE("{\"mesh\":0,\"material\":0,\"attributes\":{\"NORMAL\":"
                  "{\"channel\":%s,\"type\":\"VEC3\"}}}"),
        "{" ASSET ",\"meshes\":[],\"bufferViews\":[{\"buffer\":%s}]}",
        "{" ASSET ",\"meshes\":[],\"images\":[{\"bufferView\":%s}]}",
        "{" ASSET ",\"meshes\":[],\"accessors\":[{}],\"extensions\":{"
        "\"PMESH_progressive\":{\"accessors\":[%s]}}}"
    };
    char text[300];
    for (size_t i = 0; i < sizeof documents / sizeof *documents; i++)
        for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
            snprintf(text, sizeof text, documents[i], numbers[k]);
            CHECK(!writes(text));
        }
    CHECK(!writes("{" ASSET ",\"meshes\":[],\"bufferViews\":["
                  "{\"buffer\":0,\"byteOffset\":1e300}]}"));
    CHECK(writes("{" ASSET ",\"meshes\":[],\"bufferViews\":["
                 "{\"buffer\":0.0,\"byteOffset\":5.0}]}"));
}

/* What may be left out is. */
TEST(scene_documents_may_refer_to_nothing_from_nodes_and_animations)
{
    static const char document[] =
        "{" ASSET ",\"meshes\":[{\"primitives\":[]}],\"accessors\":[{}],"
        "\"nodes\":[{\"mesh\":1e300},{\"mesh\":-1},{\"mesh\":0.5},"
        "{\"mesh\":18446744073709551615}],"
        "\"animations\":[{\"samplers\":[{\"input\":18446744073709551615,"
        "\"output\":1099511627776},{\"input\":1e300,\"output\":-1}]}]}";
    pmesh_scene *scene = scene_of(
        SHAPE_TORUS, 8, (pmesh_scene_blob){ document, sizeof document - 1 },
        PMESH_DOCUMENT_PLAIN, 50);
    scene_budget budget;
    asset_error error;
    CHECK(writes_as_glb(scene, NULL));
    CHECK(scene_budget_open(scene, &budget, &error));
    CHECK(budget.instances[0] == 1);
    scene_budget_close(&budget);
    pmesh_scene_destroy(scene);
}

/* Places are taken from the front of a list in which they stand one by one: a
 * minute, if each moved the others. */
TEST(scene_documents_may_have_many_free_places)
{
    enum { MANY = 400000 };
    asset_bytes text = { 0 };
    asset_printf(&text, "{" ASSET ",\"accessors\":[{}],\"meshes\":[{"
                 "\"primitives\":[{\"attributes\":{},\"extensions\":{"
                 "\"PMESH_progressive\":" TORUS "}}]}],\"extensions\":{"
                 "\"PMESH_progressive\":{\"accessors\":[0");
    for (int i = 0; i < MANY; i++)
        asset_put(&text, ",0", 2);
    asset_put(&text, "]}}}", 5); /* and the end of the string */
    const clock_t start = clock();
    CHECK(writes((const char *)text.data));
    CHECK(clock() - start < 10 * CLOCKS_PER_SEC);
    asset_bytes_free(&text);
}

/* Whether a scene of a sphere is written whose document names its first
 * material, with `named` attributes and twice as many of morph targets, in
 * `primitives` primitives. */
static bool writes_often(int primitives, int named)
{
    asset_bytes text = { 0 };
    asset_printf(&text, "{" ASSET ",\"meshes\":[{\"primitives\":[");
    for (int i = 0; i < primitives; i++) {
        asset_printf(&text, "%s{\"extensions\":{\"PMESH_progressive\":{"
                     "\"mesh\":0,\"material\":0,\"attributes\":{"
                     "\"POSITION\":{}", i ? "," : "");
        for (int k = 0; k < named; k++)
            asset_printf(&text, ",\"_%d\":{\"channel\":0,\"type\":"
                         "\"VEC3\"}", k);
        asset_printf(&text, "},\"targets\":[");
        for (int k = 0; k < 2 * named; k++)
            asset_printf(&text, "%s{\"POSITION\":{\"channel\":0,"
                         "\"type\":\"VEC3\"}}", k ? "," : "");
        asset_printf(&text, "]}}}");
    }
    asset_put(&text, "]}]}", 4);
    pmesh_scene *scene = scene_packed(SHAPE_SPHERE, 64, &text);
    pmesh_scene_refine(scene, NULL, NULL);
    const bool ok = writes_as_glb(scene, NULL);
    pmesh_scene_destroy(scene);
    return ok;
}

/* A few kilobytes would become hundreds of megabytes. */
TEST(scene_documents_name_a_mesh_no_oftener_than_their_size_allows)
{
    CHECK(writes_often(100, 0));
    CHECK(!writes_often(1000, 0));
    CHECK(writes_often(1, 100));
    CHECK(!writes_often(1, 1500));
}

/* A scene with an image that is nowhere, others that share a view of `size`
 * bytes, and three materials for each. */
static pmesh_scene *scene_with_images(int images, size_t size)
{
    asset_bytes text = { 0 };
    asset_printf(&text, "{" ASSET ",\"meshes\":[],\"bufferViews\":[{"
                 "\"buffer\":0,\"byteLength\":%zu}],\"images\":[{}", size);
    for (int i = 1; i < images; i++)
        asset_printf(&text, ",{\"bufferView\":0}");
    asset_printf(&text, "],\"textures\":[{\"source\":0}");
    for (int i = 1; i < images; i++)
        asset_printf(&text, ",{\"source\":%d}", i);
    asset_printf(&text, "],\"materials\":[{}");
    for (int i = 0; i < 3 * images; i++)
        asset_printf(&text, ",{\"emissiveTexture\":{\"index\":%d}}",
                     i % images);
    asset_put(&text, "]}", 3);
    pmesh_scene *scene = scene_with((const char *)text.data);
    asset_bytes_free(&text);
    return scene;
}

TEST(scene_library_has_an_image_once)
{
    enum { IMAGES = 9 };
    scene_library library = { .stem = "s" };
    pmesh_scene *scene = scene_with_images(IMAGES, 5);
    CHECK(writes_as_glb(scene, &library));
    CHECK(library.image_count == IMAGES - 1 && library.missing);
    for (size_t i = 0; i < library.image_count; i++)
        CHECK(library.images[i].number == i + 1 &&
              library.images[i].size == 5 &&
              memcmp(library.images[i].data, "01234", 5) == 0);
    scene_library_free(&library);
    pmesh_scene_destroy(scene); /* the images are its bytes */
}

static double time_of_library(int images)
{
    scene_library library = { .stem = "s" };
    pmesh_scene *scene = scene_with_images(images, 5);
    const clock_t start = clock();
    CHECK(writes_as_glb(scene, &library));
    const double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
    CHECK(library.image_count == (size_t)images - 1);
    scene_library_free(&library);
    pmesh_scene_destroy(scene);
    return seconds;
}

/* Three materials look for each, which is not to be among all before it. */
TEST(scene_library_of_many_images_takes_time_in_proportion)
{
    const double few = time_of_library(5000), many = time_of_library(50000);
    if (getenv("PMESH_FIGURES"))
        printf("    5000 and 50000 images: %.3f and %.3f s (%.1fx)\n", few,
               many, many / few);
    CHECK(many < 20 * few + 0.05);
}

/* Each becomes a file, of the bytes that all share. */
TEST(scene_library_has_no_more_images_than_a_file_may)
{
    scene_library library = { .stem = "s" };
    pmesh_scene *scene = scene_with_images(4000, sizeof resource);
    CHECK(!writes_as_glb(scene, &library));
    scene_library_free(&library);
    pmesh_scene_destroy(scene);
}

TEST(scene_budgets_do_not_wrap_around)
{
    pmesh_scene *scene = scene_with(PRIMITIVE(TORUS));
    scene_budget budget;
    asset_error error;
    CHECK(scene_budget_open(scene, &budget, &error));
    CHECK(scene_budget_drawn(&budget) > 4 && budget.stored > 4);
    budget.instances[0] = UINT64_MAX / 4;
    CHECK(scene_budget_drawn(&budget) == UINT64_MAX);
    CHECK(scene_budget_stored(&budget, 1000000) == 1);
    scene_budget_close(&budget);
    pmesh_scene_destroy(scene);
}

/* A .gltf with one triangle in a data URI. */
#define GLTF(more)                                                          \
    "{" ASSET ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"     \
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"    \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,"  \
    "\"type\":\"VEC3\"}],\"bufferViews\":[{\"buffer\":0,"                   \
    "\"byteLength\":36}],\"buffers\":[{\"byteLength\":36,\"uri\":"          \
    "\"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}]"   \
    more "}"

static bool takes_apart(const char *text)
{
    scene_parts parts;
    asset_error error = { "", "" };
    const bool ok = scene_parts_read((const uint8_t *)text, strlen(text), NULL,
                                     false, &parts, &error);
    CHECK(ok || error.what[0] != '\0');
    if (ok)
        scene_parts_free(&parts);
    return ok;
}

TEST(scene_parts_refuse_references_that_lead_nowhere)
{
    static const char *const bad[] = {
        GLTF(",\"skins\":[{\"joints\":[0],\"inverseBindMatrices\":9}]"),
        GLTF(",\"skins\":[3]"), GLTF(",\"skins\":{\"a\":1}"),
        GLTF(",\"animations\":[{}]"),
        GLTF(",\"animations\":[{\"samplers\":[{\"input\":-1}]}]"),
        GLTF(",\"images\":[{\"bufferView\":4}]"), GLTF(",\"images\":[1]")
    };
    CHECK(takes_apart(GLTF("")));
    CHECK(takes_apart(GLTF(",\"images\":[{\"uri\":\"nowhere.png\"}]")));
    CHECK(takes_apart(GLTF(",\"extensions\":{\"X\":[0,1,2,3e9,-1,\"a\"]}")));
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        CHECK(!takes_apart(bad[i]));
}

TEST(scene_is_worth_more_than_a_mesh_if_it_has_looks)
{
    static const struct {
        const char *text;
        bool worth;
    } cases[] = {
        { GLTF(""), false },
        { GLTF(",\"materials\":[{\"name\":\"a\"}]"), false },
        { GLTF(",\"materials\":[{\"doubleSided\":true}]"), true },
        { GLTF(",\"images\":[{\"uri\":\"a.png\"}]"), true },
        { GLTF(",\"skins\":[{}]"), true },
        { "{\"meshes\":[{},{}]}", true },
        { "v 0 0 0", false }, { "", false }
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        CHECK(scene_is_worth_it((const uint8_t *)cases[i].text,
                                strlen(cases[i].text)) == cases[i].worth);
}

/* ---- packed documents --------------------------------------------------- */

TEST(packed_bytes_come_back)
{
    static uint8_t data[200000];
    const size_t sizes[] = { 0, 1, 1000, sizeof data };
    for (size_t i = 0; i < sizeof data; i++)
        data[i] = (uint8_t)(i / 100);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        asset_bytes packed = { 0 }, plain = { 0 };
        CHECK(pack_zlib(data, sizes[i], &packed));
        CHECK(unpack_zlib(packed.data, packed.size, sizes[i], &plain));
        CHECK(plain.size == sizes[i]);
        CHECK(sizes[i] == 0 || memcmp(plain.data, data, sizes[i]) == 0);
        asset_bytes_free(&plain);
        CHECK(sizes[i] == 0 || !unpack_zlib(packed.data, packed.size,
                                            sizes[i] - 1, &plain));
        asset_bytes_free(&plain);
        asset_bytes_free(&packed);
    }
}

/* A small file that unpacks to very many values, or to very much text. */
TEST(documents_that_unpack_to_too_much_are_refused)
{
    static const char *const parts[] = { "[],", "                " };
    static const char start[] = "{" ASSET ",\"extras\":[", end[] = "0]}";
    const size_t counts[] = { 1 << 20, (112 << 20) / 16 };
    for (int kind = 0; kind < 2; kind++) {
        asset_bytes text = { 0 }, out = { 0 };
        asset notes = { 0 };
        asset_error error = { "", "" };
        asset_put(&text, start, strlen(start));
        for (size_t i = 0; i < counts[kind]; i++)
            asset_put(&text, parts[kind], strlen(parts[kind]));
        asset_put(&text, end, strlen(end));
        pmesh_scene *scene = scene_packed(SHAPE_TORUS, 8, &text);
        CHECK(!scene_write(scene, (scene_style){ .glb = true }, &out, &notes,
                           &error));
        CHECK(strstr(error.what, kind ? "cannot be unpacked"
                                      : "unpacks to more than"));
        asset_bytes_free(&out);
        pmesh_scene_destroy(scene);
    }
}

TEST(packed_bytes_that_are_damaged_or_cut_off_are_refused)
{
    static const char text[] = "{\"asset\": {\"version\": \"2.0\"}}";
    asset_bytes packed = { 0 };
    CHECK(pack_zlib(text, sizeof text, &packed));
    for (size_t i = 0; i < packed.size; i++) {
        asset_bytes plain = { 0 };
        CHECK(!unpack_zlib(packed.data, i, 1000, &plain));
        asset_bytes_free(&plain);
        packed.data[i] ^= 0x10;
        const bool good = unpack_zlib(packed.data, packed.size, 1000, &plain);
        CHECK(!good || (plain.size == sizeof text &&
                        memcmp(plain.data, text, sizeof text) == 0));
        asset_bytes_free(&plain);
        packed.data[i] ^= 0x10;
    }
    asset_bytes_free(&packed);
}
