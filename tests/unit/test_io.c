/* SPDX-License-Identifier: MIT */
#include "tools/asset.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/unit/test.h"

/* ---- helpers ------------------------------------------------------------- */

#define TETRA_OBJ                                                            \
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"                                   \
    "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
#define PLY_VERTICES                                                         \
    "element vertex 4\nproperty float x\nproperty float y\n"                 \
    "property float z\n"
#define PLY_FACES "property list uchar int vertex_indices\nend_header\n"
#define PLY_POINTS "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
#define FACET                                                                \
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"           \
    "vertex 0 1 0\nendloop\nendfacet\n"

static asset_error error;

/* Reads a copy that ends where its memory does: ASan sees the next byte. */
static bool read_bytes(asset_format format, const void *data, size_t size,
                       asset *out)
{
    uint8_t *copy = malloc(size ? size : 1);
    CHECK(copy);
    memcpy(copy, data, size);
    const bool ok = asset_read(copy, size, format, NULL, out, &error);
    free(copy);
    return ok;
}

static bool read_text(asset_format format, const char *text, asset *out)
{
    return read_bytes(format, text, strlen(text), out);
}

static bool is_refused(asset_format format, const char *text)
{
    asset mesh;
    if (read_text(format, text, &mesh))
        return false;
    return !mesh.positions && !mesh.indices && error.what[0];
}

static bool has_corners(const asset *mesh, size_t face, uint32_t a, uint32_t b,
                        uint32_t c)
{
    const uint32_t *v = mesh->indices + 3 * face;
    return face < mesh->face_count && v[0] == a && v[1] == b && v[2] == c;
}

static const asset_attribute *attribute(const asset *mesh,
                                        pmesh_attribute_kind kind)
{
    for (size_t i = 0; i < mesh->attribute_count; i++)
        if (mesh->attributes[i].kind == kind)
            return &mesh->attributes[i];
    return NULL;
}

static const float *values_at(const asset *mesh, const asset_attribute *a,
                              size_t corner)
{
    const uint32_t tuple =
        a->indices ? a->indices[corner] : mesh->indices[corner];
    return a->values + (size_t)tuple * a->components;
}

/* Same faces, same positions at their corners, same attribute values to
 * `tolerance`. */
static bool same_surface(const asset *a, const asset *b, float tolerance)
{
    if (a->face_count != b->face_count ||
        a->attribute_count != b->attribute_count)
        return false;
    for (size_t c = 0; c < 3 * a->face_count; c++)
        if (memcmp(a->positions + 3 * (size_t)a->indices[c],
                   b->positions + 3 * (size_t)b->indices[c],
                   3 * sizeof(double)) != 0)
            return false;
    for (size_t i = 0; i < a->attribute_count; i++) {
        const asset_attribute *x = &a->attributes[i];
        const asset_attribute *y = attribute(b, x->kind);
        if (!y || y->components != x->components)
            return false;
        for (size_t c = 0; c < 3 * a->face_count; c++)
            for (int k = 0; k < x->components; k++)
                if (fabsf(values_at(a, x, c)[k] - values_at(b, y, c)[k]) >
                    tolerance)
                    return false;
    }
    return true;
}

static bool survives(const asset *mesh, asset_format format, float tolerance)
{
    asset_bytes bytes = { 0 };
    asset back;
    CHECK(asset_write(mesh, format, &bytes, &error));
    CHECK(read_bytes(format, bytes.data, bytes.size, &back));
    const bool same = same_surface(mesh, &back, tolerance);
    asset_free(&back);
    asset_bytes_free(&bytes);
    return same;
}

/* ---- numbers ------------------------------------------------------------- */

static double parse(const char *text)
{
    double value = 0;
    const char *end = text + strlen(text);
    CHECK(asset_number_parse(text, end, &value) == end);
    return value;
}

static const char *print(double value)
{
    static char text[33];
    text[asset_number_print(text, value)] = '\0';
    return text;
}

TEST(number_parse_rounds_correctly_at_the_hard_places)
{
    CHECK(parse("9007199254740993") == 9007199254740992.0); /* tie to even */
    CHECK(parse("9007199254740993.0000000000000000000001") ==
          9007199254740994.0);
    CHECK(parse("1.00000000000000011102230246251565404") == 1.0);
    CHECK(parse("1.00000000000000011102230246251565405") > 1.0);
    CHECK(parse("2.2250738585072011e-308") == 0x0.fffffffffffffp-1022);
    CHECK(parse("2.4703282292062327e-324") == 0);
    CHECK(parse("2.4703282292062328e-324") == 0x1p-1074);
    CHECK(parse("1.7976931348623158e308") == 0x1.fffffffffffffp1023);
    CHECK(isinf(parse("1.7976931348623159e308")));
    CHECK(parse("123456789012345678901234567890e-20") == 1234567890.1234567);
    CHECK(parse("1e23") == 0x1.52d02c7e14af6p76);
    CHECK(parse("3.5e-27") == 3.5e-27);
}

TEST(number_parse_takes_all_usual_forms)
{
    CHECK(parse("1.") == 1 && parse(".5") == 0.5 && parse("+2E+00") == 2);
    CHECK(parse("-0") == 0 && signbit(parse("-0")));
    CHECK(parse("0e999999999999999999999") == 0);
    CHECK(parse("1e-99999999999999999999") == 0);
    CHECK(isinf(parse("1e400")) && isinf(parse("-Infinity")));
    CHECK(isnan(parse("nan")) && isnan(parse("-nan(ind)")));
    CHECK(isnan(parse("-1.#IND")) && isinf(parse("1.#INF00")));
    CHECK(isnan(parse("1.#QNAN0")));
}

TEST(number_parse_stops_at_the_end_and_at_strangers)
{
    static const char *const none[] = { "", "-", ".", "e5", "+", "abc", "-.e" };
    double value;
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++)
        CHECK(asset_number_parse(none[i], none[i] + strlen(none[i]), &value) ==
              none[i]);
    const char *text = "12,5";
    CHECK(asset_number_parse(text, text + 4, &value) == text + 2);
    text = "1.5e+";
    CHECK(asset_number_parse(text, text + 5, &value) == text + 3);
    text = "1.#note";
    CHECK(asset_number_parse(text, text + 7, &value) == text + 2);
    text = "123";
    CHECK(asset_number_parse(text, text + 2, &value) == text + 2);
    CHECK(value == 12);
}

TEST(number_print_is_short)
{
    CHECK(strcmp(print(0.1), "0.1") == 0);
    CHECK(strcmp(print(-0.0), "-0") == 0);
    CHECK(strcmp(print(1e16), "10000000000000000") == 0);
    CHECK(strcmp(print(123.456), "123.456") == 0);
    CHECK(strcmp(print(0x1p-1074), "5e-324") == 0);
    CHECK(strcmp(print(1e100), "1e+100") == 0);
    CHECK(strcmp(print(0.1 + 0.2), "0.30000000000000004") == 0);
    CHECK(strcmp(print((double)NAN), "nan") == 0);
    CHECK(strcmp(print(-(double)INFINITY), "-inf") == 0);
    char text[32];
    CHECK(asset_number_print_float(text, 0.1f) == 3);
    CHECK(memcmp(text, "0.1", 3) == 0);
}

TEST(number_print_reads_back_as_the_same_number)
{
    uint64_t state = 1;
    for (int i = 0; i < 100000; i++) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        const uint64_t bits = i % 2 ? state : state >> 2 | 1022ull << 52;
        const uint32_t low = (uint32_t)(bits >> 32);
        double value, back;
        float single;
        char text[32];
        memcpy(&value, &bits, sizeof value);
        memcpy(&single, &low, sizeof single);
        size_t size = asset_number_print(text, value);
        CHECK(size <= sizeof text);
        CHECK(asset_number_parse(text, text + size, &back) == text + size);
        CHECK(back == value || isnan(value));
        size = asset_number_print_float(text, single);
        CHECK(asset_number_parse(text, text + size, &back) == text + size);
        CHECK((float)back == single || isnan(single));
    }
}

/* ---- triangulation ------------------------------------------------------- */

/* Every triangle turns like the polygon, and their areas sum up to its. */
static bool covers(const double (*p)[3], size_t n)
{
    uint32_t *out = malloc(3 * (n - 2) * sizeof *out);
    CHECK(out);
    asset_triangulate(p, n, out);
    double area = 0, sum = 0;
    bool ok = true;
    for (size_t i = 0; i < n; i++) {
        const double *a = p[i], *b = p[(i + 1) % n];
        area += a[0] * b[1] - a[1] * b[0];
    }
    for (size_t i = 0; i < 3 * (n - 2); i += 3) {
        const double *a = p[out[i]], *b = p[out[i + 1]], *c = p[out[i + 2]];
        const double twice = (b[0] - a[0]) * (c[1] - a[1]) -
                             (b[1] - a[1]) * (c[0] - a[0]);
        ok = ok && twice * area >= 0;
        sum += twice;
    }
    free(out);
    return ok && fabs(sum - area) <= 1e-9 * fabs(area);
}

TEST(triangulate_covers_a_concave_quad_of_either_sense)
{
    static const double dart[][3] = {
        { 0, 0, 0 }, { 2, 1, 0 }, { 4, 0, 0 }, { 2, 4, 0 }
    };
    for (size_t first = 0; first < 4; first++) {
        double turned[4][3], back[4][3];
        for (size_t i = 0; i < 4; i++) {
            memcpy(turned[i], dart[(first + i) % 4], sizeof turned[i]);
            memcpy(back[3 - i], turned[i], sizeof turned[i]);
        }
        CHECK(covers((const double(*)[3])turned, 4));
        CHECK(covers((const double(*)[3])back, 4));
    }
}

TEST(triangulate_covers_tilted_stars_combs_and_spirals)
{
    enum { N = 4000 };
    static double p[N][3];
    for (size_t i = 0; i < N; i++) {
        const double a = 6.28318530717958 * (double)i / N;
        const double r = 1 + (double)(i * 7919 % 1000) / 500;
        p[i][0] = r * cos(a);
        p[i][1] = r * sin(a);
        p[i][2] = 0.4 * p[i][0] - 0.3 * p[i][1];
    }
    CHECK(covers((const double(*)[3])p, N));
    for (size_t i = 0; i < N; i++) {
        p[i][0] = (double)(i / 2);
        p[i][1] = i % 4 == 1 || i % 4 == 2 ? 100 : 1;
        p[i][2] = 0;
    }
    p[N - 2][1] = p[N - 1][1] = 0;
    p[N - 1][0] = 0;
    CHECK(covers((const double(*)[3])p, N));
    for (size_t i = 0; i < N / 2; i++) {
        const double a = 0.02 * (double)i;
        p[i][0] = (a + 8) * cos(a);
        p[i][1] = (a + 8) * sin(a);
        p[N - 1 - i][0] = (a + 10) * cos(a);
        p[N - 1 - i][1] = (a + 10) * sin(a);
    }
    CHECK(covers((const double(*)[3])p, N));
}

TEST(triangulate_ends_on_polygons_that_are_none)
{
    enum { N = 3000 };
    static double p[N][3];
    static uint32_t out[3 * (N - 2)];
    for (int kind = 0; kind < 4; kind++) {
        for (size_t i = 0; i < N; i++) {
            p[i][0] = kind == 0 ? 1 : (double)(i * 7919 % 1009);
            p[i][1] = kind == 1 ? 0 : (double)(i * 104729 % 1013);
            p[i][2] = kind == 2 && i == 5 ? (double)NAN : 0;
        }
        asset_triangulate((const double(*)[3])p, N, out);
        for (size_t i = 0; i < 3 * (N - 2); i++)
            CHECK(out[i] < N);
    }
}

/* ---- OBJ ----------------------------------------------------------------- */

TEST(obj_reads_every_corner_form)
{
    asset mesh;
    CHECK(read_text(ASSET_OBJ,
                    "\xEF\xBB\xBF# made by hand\r\n\tv 0 0 0\r\nv 1 0 0 # c\n"
                    "v 0 1 0 1.0\nv 0\\\n 0 1\nvt 0.25 0.75\nvn 0 0 2\n"
                    "f -4 -2 -3\nf 1/1 2/1 4/1\nf 2//1 3//1 4//1\n"
                    "f 1/1/1 4/1/1 3/1/1",
                    &mesh));
    CHECK(mesh.vertex_count == 4 && mesh.face_count == 4);
    CHECK(has_corners(&mesh, 0, 0, 2, 1) && has_corners(&mesh, 3, 0, 3, 2));
    const asset_attribute *uv = attribute(&mesh, PMESH_TEXCOORD);
    CHECK(uv && values_at(&mesh, uv, 3)[1] == 0.75f);
    CHECK(values_at(&mesh, uv, 0)[1] == 0); /* corners without: zero */
    const asset_attribute *normal = attribute(&mesh, PMESH_NORMAL);
    CHECK(normal && values_at(&mesh, normal, 6)[2] == 1); /* made unit */
    const float *n = values_at(&mesh, normal, 3); /* from the faces around */
    CHECK(fabsf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1) < 1e-5f);
    CHECK(mesh.warnings[0]);
    asset_free(&mesh);
}

TEST(obj_reads_colors_and_makes_the_others_white)
{
    asset mesh;
    CHECK(read_text(ASSET_OBJ,
                    "v 0 0 0\nv 1 0 0 1 0.5 0\nv 0 1 0 -1 5 0.25\nf 1 2 3\n",
                    &mesh));
    const asset_attribute *color = attribute(&mesh, PMESH_COLOR);
    CHECK(color && !color->indices && color->count == 3);
    CHECK(color->values[0] == 1 && color->values[4] == 0.5f);
    CHECK(color->values[6] == 0 && color->values[7] == 1); /* clamped */
    asset_free(&mesh);
}

TEST(obj_names_materials_in_order_of_use)
{
    asset mesh;
    CHECK(read_text(ASSET_OBJ,
                    "mtllib ../../x.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
                    "usemtl never used\nusemtl red \x1B[1m\xFF \nf 1 2 3\n"
                    "usemtl b\nf 1 3 2\nusemtl red \x1B[1m\xFF\nf 2 3 1\n",
                    &mesh));
    CHECK(mesh.material_count == 2 && mesh.materials);
    CHECK(strcmp(mesh.material_names[0], "red ?[1m?") == 0);
    CHECK(strcmp(mesh.material_names[1], "b") == 0);
    CHECK(mesh.materials[0] == 0 && mesh.materials[1] == 1);
    CHECK(mesh.materials[2] == 0);
    CHECK(survives(&mesh, ASSET_OBJ, 0));
    asset_free(&mesh);
}

TEST(obj_splits_polygons_even_before_their_vertices)
{
    asset mesh;
    CHECK(read_text(ASSET_OBJ,
                    "f 1 2 3 4 5\nf 1 2\nf 1\nf\nv 0 0 0\nv 2 1 0\nv 4 0 0\n"
                    "v 4 4 0\nv 0 4 0\n",
                    &mesh));
    CHECK(mesh.face_count == 3 && mesh.warnings[0]);
    double area = 0;
    for (size_t f = 0; f < 3; f++) {
        const uint32_t *v = mesh.indices + 3 * f;
        const double *a = mesh.positions + 3 * v[0],
                     *b = mesh.positions + 3 * v[1],
                     *c = mesh.positions + 3 * v[2];
        area += fabs((b[0] - a[0]) * (c[1] - a[1]) -
                     (b[1] - a[1]) * (c[0] - a[0])) / 2;
    }
    CHECK(area == 14);
    asset_free(&mesh);
}

TEST(obj_says_where_it_is_wrong)
{
    CHECK(is_refused(ASSET_OBJ, "v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\n"));
    CHECK(strcmp(error.where, "line 5") == 0);
    CHECK(is_refused(ASSET_OBJ, TETRA_OBJ "f 0 1 2\n"));
    CHECK(strcmp(error.where, "line 9") == 0);
    CHECK(is_refused(ASSET_OBJ, TETRA_OBJ "f 4294967297 1 2\n"));
    CHECK(is_refused(ASSET_OBJ, TETRA_OBJ "f -5 -1 -2\n"));
    CHECK(is_refused(ASSET_OBJ, TETRA_OBJ "f 1/9 2/1 3/1\n"));
    CHECK(is_refused(ASSET_OBJ, TETRA_OBJ "f 1 2x 3\n"));
    CHECK(is_refused(ASSET_OBJ, TETRA_OBJ "v 1,5 0 0\n"));
    CHECK(is_refused(ASSET_OBJ, TETRA_OBJ "v 0 0\n"));
    CHECK(is_refused(ASSET_OBJ, "v 0 0 0\nl 1 1\np 1\n"));
    CHECK(is_refused(ASSET_OBJ, ""));
}

TEST(reader_keeps_positions_that_are_not_finite)
{
    asset mesh;
    CHECK(read_text(ASSET_OBJ, TETRA_OBJ "v nan inf 1e400\nf 1 2 5\n", &mesh));
    CHECK(mesh.face_count == 5 && isnan(mesh.positions[12]));
    asset_free(&mesh);
}

/* ---- PLY ----------------------------------------------------------------- */

TEST(ply_reads_ascii_attributes_in_any_order)
{
    asset mesh;
    CHECK(read_text(ASSET_PLY,
                    "ply\ncomment element\nformat ascii 1.0\n"
                    "element face 1\nproperty uchar flags\n"
                    "property list ushort uint vertex_index\n"
                    "element junk 2\nproperty list int float a\n"
                    "element vertex 3\nproperty uchar red\nproperty double z\n"
                    "property short y\nproperty list uchar int more\n"
                    "property uchar green\nproperty uchar blue\n"
                    "property float x\nproperty float quality\n"
                    "property float s\nproperty float t\nend_header\n"
                    "7 3 2 1 0\n2 9 9\n0\n"
                    "255 0.5 1 0 0 51 10 0.25 0 1\n0 0 2 1 9 0 0 20 0.5 0 1\n"
                    "0 0 -3 0 0 0 30 0.75 0 1\n",
                    &mesh));
    CHECK(mesh.face_count == 1 && has_corners(&mesh, 0, 2, 1, 0));
    CHECK(mesh.positions[0] == 10 && mesh.positions[1] == 1);
    CHECK(mesh.positions[2] == 0.5 && mesh.positions[7] == -3);
    const asset_attribute *color = attribute(&mesh, PMESH_COLOR);
    CHECK(color && color->components == 3 && color->values[0] == 1);
    CHECK(color->values[2] == 51 / 255.0f);
    const asset_attribute *quality = attribute(&mesh, PMESH_GENERIC);
    CHECK(quality && quality->components == 1 && quality->values[2] == 0.75f);
    CHECK(attribute(&mesh, PMESH_TEXCOORD) && !attribute(&mesh, PMESH_NORMAL));
    asset_free(&mesh);
}

TEST(ply_reads_big_endian_behind_a_dos_header)
{
    static const char head[] = "ply\r\nformat binary_big_endian 1.0\r\n"
                               "element vertex 3\r\nproperty short x\r\n"
                               "property char y\r\nproperty float z\r\n"
                               "element face 1\r\n"
                               "property list ushort uchar vertex_indices\r\n"
                               "end_header\r\n";
    static const char data[] = "\x01\x00\xFF\x3F\x80\0\0"
                               "\0\0\0\0\0\0\0\0\x02\x01\0\0\0\0"
                               "\0\x03\x00\x01\x02";
    char all[sizeof head + sizeof data];
    const size_t size = sizeof head - 1 + sizeof data - 1;
    asset mesh;
    memcpy(all, head, sizeof head - 1);
    memcpy(all + sizeof head - 1, data, sizeof data - 1);
    CHECK(read_bytes(ASSET_PLY, all, size, &mesh));
    CHECK(mesh.positions[0] == 256 && mesh.positions[1] == -1);
    CHECK(mesh.positions[2] == 1 && has_corners(&mesh, 0, 0, 1, 2));
    asset_free(&mesh);
    for (size_t cut = 1; cut < size; cut++)
        CHECK(!read_bytes(ASSET_PLY, all, size - cut, &mesh));
}

TEST(ply_takes_the_first_of_two_properties_of_one_name)
{
    asset mesh;
    CHECK(read_text(ASSET_PLY,
                    "ply\nformat ascii 1.0\nelement vertex 3\n"
                    "property float x\nproperty float y\nproperty float z\n"
                    "property float x\nelement face 1\n"
                    "property list uchar int vertex_indices\nend_header\n"
                    "0 0 0 7\n1 0 0 7\n0 1 0 7\n3 0 1 2\n",
                    &mesh));
    CHECK(mesh.positions[0] == 0 && mesh.positions[3] == 1);
    asset_free(&mesh);
}

TEST(ply_unrolls_triangle_strips)
{
    asset mesh;
    CHECK(read_text(ASSET_PLY,
                    "ply\nformat ascii 1.0\n" PLY_VERTICES
                    "element tristrips 1\n" PLY_FACES PLY_POINTS
                    "8 0 1 2 3 -1 3 2 1\n",
                    &mesh));
    CHECK(mesh.face_count == 3 && has_corners(&mesh, 0, 0, 1, 2));
    CHECK(has_corners(&mesh, 1, 2, 1, 3) && has_corners(&mesh, 2, 3, 2, 1));
    asset_free(&mesh);
}

TEST(ply_refuses_counts_that_the_file_cannot_hold)
{
    static const char *const counts[] = { "4000000000", "18446744073709551617",
                                          "-1", "x", "4294967299", "5" };
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        char text[512] = "ply\nformat ascii 1.0\n" PLY_VERTICES "element face ";
        strcat(strcat(text, counts[i]),
               "\n" PLY_FACES PLY_POINTS "3 0 1 2\n");
        CHECK(is_refused(ASSET_PLY, text));
    }
#define ONE_FACE "ply\nformat ascii 1.0\n" PLY_VERTICES "element face 1\n"
    CHECK(is_refused(ASSET_PLY, ONE_FACE PLY_FACES PLY_POINTS
                     "4000000000 0 1 2\n"));
    CHECK(is_refused(ASSET_PLY, ONE_FACE PLY_FACES PLY_POINTS "3 0 1 4\n"));
    CHECK(strcmp(error.where, "line 14") == 0);
    CHECK(is_refused(ASSET_PLY, ONE_FACE PLY_FACES PLY_POINTS "3 0 1 -1\n"));
    CHECK(is_refused(ASSET_PLY, ONE_FACE PLY_FACES PLY_POINTS "3 0 1 1.5\n"));
    CHECK(is_refused(ASSET_PLY, ONE_FACE PLY_FACES "0 0 0\n1 0\n0 1 0\n"
                                                   "0 0 1 0\n3 0 1 2\n"));
}

/* ---- STL ----------------------------------------------------------------- */

TEST(stl_joins_equal_positions)
{
    asset mesh;
    CHECK(read_text(ASSET_STL,
                    "solid facet normal a\n" FACET "endsolid\nSOLID\n" FACET
                    "facet normal nan 0 0 outer loop vertex -0 0 0 vertex 0 1 0"
                    " vertex 0 0 1 endloop endfacet endsolid x",
                    &mesh));
    CHECK(mesh.face_count == 3 && mesh.vertex_count == 5);
    CHECK(has_corners(&mesh, 1, 0, 1, 2) && has_corners(&mesh, 2, 3, 2, 4));
    CHECK(mesh.positions[9] == 0 && signbit(mesh.positions[9]));
    CHECK(!mesh.warnings[0]);
    asset_free(&mesh);
    CHECK(is_refused(ASSET_STL, "solid\n"));
    CHECK(is_refused(ASSET_STL, "solid\nfacet normal 0 0 1\nouter loop\n"));
    CHECK(is_refused(ASSET_STL, "solid\n" FACET "facet normal 0 0 x\n"));
    CHECK(strcmp(error.where, "line 9") == 0);
}

TEST(stl_is_binary_where_its_size_fits_its_count)
{
    asset mesh, back;
    asset_bytes out = { 0 };
    CHECK(read_text(ASSET_OBJ, TETRA_OBJ, &mesh));
    CHECK(asset_write(&mesh, ASSET_STL, &out, &error));
    CHECK(out.size == 84 + 50 * 4);
    memcpy(out.data, "solid", 5);
    CHECK(read_bytes(ASSET_UNKNOWN, out.data, out.size, &back));
    CHECK(back.vertex_count == 4 && same_surface(&mesh, &back, 0));
    asset_free(&back);
    for (size_t cut = 1; cut < out.size; cut++)
        CHECK(!read_bytes(ASSET_STL, out.data, out.size - cut, &back));
    asset_put(&out, "behind", 6);
    CHECK(read_bytes(ASSET_STL, out.data, out.size, &back));
    asset_free(&back);
    asset_bytes_free(&out);
    asset_free(&mesh);
}

/* ---- OFF ----------------------------------------------------------------- */

TEST(off_reads_its_variants)
{
    static const char *const texts[] = {
        "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        "# c\nOFF 3 1\n\n0 0 0 # c\n1 0 0\n# c\n0 1 0\n3 0 1 2 255 0 0\n",
        "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 0.5 0 0",
        ("STCNOFF\n3 1 0\n0 0 0 0 0 1 255 0 51 0 1\n"
         "1 0 0 0 0 1 255 0 51 0 1\n0 1 0 0 0 1 255 0 51 0 1\n3 0 1 2\n"),
    };
    asset mesh;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        CHECK(read_text(ASSET_OFF, texts[i], &mesh));
        CHECK(mesh.face_count == 1 && has_corners(&mesh, 0, 0, 1, 2));
        CHECK(mesh.vertex_count == 3 && mesh.positions[3] == 1);
        CHECK(mesh.attribute_count == (i == 3 ? 3 : 0));
        if (i == 3)
            CHECK(attribute(&mesh, PMESH_COLOR)->values[2] == 0.2f);
        asset_free(&mesh);
    }
    CHECK(is_refused(ASSET_OFF, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2\n"));
    CHECK(is_refused(ASSET_OFF, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"));
    CHECK(is_refused(ASSET_OFF, "OFF\n4000000000 1 0\n0 0 0\n"));
    CHECK(is_refused(ASSET_OFF, "4OFF\n1 1 0\n0 0 0 0\n3 0 0 0\n"));
}

TEST(off_reads_binary)
{
    static const char data[] = "OFF BINARY\n\0\0\0\3\0\0\0\1\0\0\0\0"
                               "\0\0\0\0\0\0\0\0\0\0\0\0"
                               "\x3F\x80\0\0\0\0\0\0\0\0\0\0"
                               "\0\0\0\0\x3F\x80\0\0\0\0\0\0"
                               "\0\0\0\3\0\0\0\0\0\0\0\1\0\0\0\2\0\0\0\0";
    asset mesh;
    CHECK(read_bytes(ASSET_UNKNOWN, data, sizeof data - 1, &mesh));
    CHECK(mesh.positions[3] == 1 && has_corners(&mesh, 0, 0, 1, 2));
    asset_free(&mesh);
    for (size_t size = 0; size < sizeof data - 1; size++)
        CHECK(!read_bytes(ASSET_OFF, data, size, &mesh));
}

/* ---- all formats --------------------------------------------------------- */

TEST(writers_keep_what_their_format_can_say)
{
    asset mesh;
    CHECK(read_text(ASSET_OBJ,
                    "v 0.1 0 0 1 0 0\nv 1 1e-9 0 0 1 0\nv 0 1e300 0 0 0 1\n"
                    "v 0 0 -1 1 1 1\nvt 0 0\nvt 0.1 1\nvn 0 0 1\nvn 1 0 0\n"
                    "f 1/1/1 2/2/1 3/1/2\nf 1/2/2 3/1/2 4/1/1\n",
                    &mesh));
    CHECK(survives(&mesh, ASSET_OBJ, 0));
    CHECK(survives(&mesh, ASSET_PLY, 0.002f)); /* colours become bytes */
    const size_t count = mesh.attribute_count;
    mesh.attribute_count = 0;
    CHECK(survives(&mesh, ASSET_OFF, 0));
    CHECK(survives(&mesh, ASSET_OBJ, 0));
    mesh.attribute_count = count;
    asset_free(&mesh);
}

TEST(format_follows_from_the_name_or_the_bytes)
{
    asset mesh;
    CHECK(asset_format_of("a.b/c.OBJ") == ASSET_OBJ);
    CHECK(asset_format_of("glb") == ASSET_GLB);
    CHECK(asset_format_of("a.obj/c") == ASSET_UNKNOWN);
    CHECK(asset_format_of("c.gltf") == ASSET_GLTF);
    CHECK(asset_format_of("") == ASSET_UNKNOWN);
    CHECK(read_text(ASSET_UNKNOWN, "# c\n" TETRA_OBJ, &mesh));
    asset_free(&mesh);
    CHECK(read_text(ASSET_UNKNOWN, "solid\n" FACET "endsolid\n", &mesh));
    asset_free(&mesh);
    CHECK(is_refused(ASSET_UNKNOWN, "\x7F" "ELF"));
}

TEST(messages_hold_no_control_characters)
{
    asset mesh = { 0 };
    CHECK(!asset_fail(&error, "line\n1", "a\x1B[1m %s",
                      "\xC2\x9B\xFF\xC3\xA9"));
    CHECK(strcmp(error.where, "line?1") == 0);
    CHECK(strcmp(error.what, "a?[1m ???\xC3\xA9") == 0);
    for (int i = 0; i < 1000; i++)
        asset_warn(&mesh, "warning %d\n", i);
    CHECK(strlen(mesh.warnings) < sizeof mesh.warnings);
    CHECK(strncmp(mesh.warnings, "warning 0?\nwarning 1?\n", 22) == 0);
}
