/* SPDX-License-Identifier: MIT */
/*
 * bench_speed - our speed and memory beside those of other programs.
 *
 *   bench_speed RUNS MODEL
 *   bench_speed RUNS scale FACES...
 *
 * Everything works from memory to memory, in this process and, where nothing
 * else is said, in one thread. In each of RUNS rounds all take their turn, in
 * one direction and in the other one by turns, so that a machine that slows
 * down is unfair to nobody. Times are medians of CPU time, ratios medians of
 * the rounds' own ratios; memory is what our allocator hooks were asked for at
 * most at a time, so it does not count the input. A line of CSV for each
 * comparison:
 *
 *   model,faces,what,ours,peer,unit,figure,must,aim
 *
 * `ours` and `peer` are in the unit. The figure is ours by the peer's, or ours
 * alone; `must` and `aim` are bounds of it ("<3", ">20"), or empty.
 *
 * "scale" takes generated meshes instead and prints for each
 *
 *   faces,what,us_per_face,bytes_per_face
 */
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <exception>
#include <functional>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include "decoder/pmesh_decode.h"
#include "encoder/pmesh_encode.h"
extern "C" {
#include "tools/load.h"
#include "tools/sample.h"
}
#include "tests/bench/parsers.h"
#include "tests/bench/peers.h"

namespace {

constexpr std::uint32_t base_faces = 100;
constexpr int decode_bits = 12;

/* ---- memory ---- */

/* What our allocator hooks have given out, now and at most. */
struct Ledger {
    std::size_t now = 0, most = 0;
    pmesh_allocator hooks() { return { give, take, this }; }

    static void *give(void *user, std::size_t size)
    {
        Ledger *ledger = static_cast<Ledger *>(user);
        ledger->now += size;
        ledger->most = std::max(ledger->most, ledger->now);
        return std::malloc(size);
    }
    static void take(void *user, void *block, std::size_t size)
    {
        static_cast<Ledger *>(user)->now -= block ? size : 0;
        std::free(block);
    }
};

/* ---- ours ---- */

/* Positions and faces of a mesh, in all the forms that somebody asks for. */
struct Model {
    std::string name;
    std::vector<double> positions;
    std::vector<float> floats;
    std::vector<std::uint32_t> indices;
    Soup soup;
    std::size_t faces() const { return indices.size() / 3; }
};

/* The encoder asks for the time before and after each of its stages: the
 * fourth time when all contractions are done. */
struct Stages {
    Ledger ledger;
    int asked = 0;
    double contracted_ms = 0; /* import included */
    std::size_t contracted_most = 0;
    double all_ms = 0;
    Bytes bytes;
} *stages;

double stage_clock()
{
    if (++stages->asked <= 4)
        stages->contracted_most = stages->ledger.most;
    return cpu_ms();
}

int collect(void *user, const void *data, std::size_t size)
{
    Bytes *bytes = static_cast<Bytes *>(user);
    const std::uint8_t *from = static_cast<const std::uint8_t *>(data);
    bytes->insert(bytes->end(), from, from + size);
    return 0;
}

/* Stops at the first word about what comes behind the contractions. */
int stop_at_code(void *, const char *stage, double)
{
    return std::strcmp(stage, "code") == 0;
}

Stages encode(const Model &m, const pmesh_encoder_config &how,
              bool contract_only)
{
    Stages result;
    pmesh_encoder_config config = how;
    pmesh_mesh_input in = {};
    pmesh_encode_report report = {};
    stages = &result;
    in.positions = m.positions.data();
    in.vertex_count = m.positions.size() / 3;
    in.indices = m.indices.data();
    in.face_count = m.faces();
    config.allocator = result.ledger.hooks();
    if (contract_only)
        config.progress = stop_at_code;
    report.clock = stage_clock;
    const double start = cpu_ms();
    const pmesh_status status =
        pmesh_encode(&in, &config, collect, &result.bytes, &report);
    result.all_ms = cpu_ms() - start;
    expect(status == (contract_only ? PMESH_E_CANCELLED : PMESH_OK),
           "pmesh_encode() failed");
    result.contracted_ms = report.seconds_import + report.seconds_contract;
    return result;
}

pmesh_encoder_config contraction(pmesh_metric metric, pmesh_placement placement)
{
    pmesh_encoder_config config = pmesh_encoder_config_default();
    config.metric = metric;
    config.placement = placement;
    config.base_faces = base_faces;
    config.threads = 1;
    return config;
}

double contract(const Model &m, pmesh_metric metric, pmesh_placement placement)
{
    return encode(m, contraction(metric, placement), true).contracted_ms;
}

pmesh_encoder_config balanced(std::uint32_t threads)
{
    pmesh_encoder_config config = pmesh_encoder_config_default();
    config.threads = threads;
    return config;
}

double bake(const Model &m)
{
    return encode(m, balanced(1), false).all_ms;
}

double bake_wall(const Model &m, std::uint32_t threads)
{
    const double start = clock_ms(CLOCK_MONOTONIC);
    encode(m, balanced(threads), false);
    return clock_ms(CLOCK_MONOTONIC) - start;
}

double simplify(const Model &m)
{
    std::vector<std::uint32_t> indices(m.indices.size());
    std::vector<double> positions(m.positions.size());
    pmesh_simplify_options options = pmesh_simplify_options_default();
    pmesh_simplify_input in = {};
    pmesh_simplify_output out = {};
    in.indices = m.indices.data();
    in.face_count = m.faces();
    in.vertex_count = m.positions.size() / 3;
    in.doubles = m.positions.data();
    options.faces = base_faces;
    out.indices = indices.data();
    out.positions = positions.data();
    const double start = cpu_ms();
    expect(pmesh_simplify_mesh(&in, &options, &out) == PMESH_OK,
           "pmesh_simplify_mesh() failed");
    return cpu_ms() - start;
}

using Decoder = std::unique_ptr<pmesh_decoder, void (*)(pmesh_decoder *)>;

Decoder decoder_of(const Bytes &bytes, const pmesh_decoder_config *config)
{
    pmesh_decoder *created;
    expect(pmesh_decoder_create(&created, config) == PMESH_OK, "no decoder");
    Decoder dec(created, pmesh_decoder_destroy);
    expect(pmesh_decoder_feed(dec.get(), bytes.data(), bytes.size()) ==
               PMESH_OK, "the stream is incomplete");
    return dec;
}

/* To an index buffer and a buffer of float positions. */
double decode(const Bytes &bytes)
{
    const double start = cpu_ms();
    const Decoder dec = decoder_of(bytes, nullptr);
    pmesh_view view;
    expect(pmesh_decoder_refine(dec.get(), nullptr, nullptr) == PMESH_OK &&
               pmesh_decoder_mesh(dec.get(), &view) == PMESH_OK, "no mesh");
    std::vector<std::uint32_t> indices(
        view.indices, view.indices + 3 * std::size_t{ view.face_count });
    std::vector<float> positions(3 * std::size_t{ view.vertex_count });
    pmesh_decoder_copy_positions(dec.get(), positions.data(), 0);
    return cpu_ms() - start;
}

std::size_t decode_memory(const Bytes &bytes)
{
    Ledger ledger;
    pmesh_decoder_config config = pmesh_decoder_config_default();
    config.allocator = ledger.hooks();
    const Decoder dec = decoder_of(bytes, &config);
    pmesh_decoder_refine(dec.get(), nullptr, nullptr);
    return ledger.most;
}

/* Milliseconds for a million faces that appear or go. */
double refine(const Bytes &bytes)
{
    constexpr int walks = 20;
    const Decoder dec = decoder_of(bytes, nullptr);
    const pmesh_target base = { 1, 0, 0, 0 };
    pmesh_header h;
    pmesh_decoder_header(dec.get(), &h);
    const double start = cpu_ms();
    for (int i = 0; i < walks; i++) {
        pmesh_decoder_refine(dec.get(), &base, nullptr);
        pmesh_decoder_refine(dec.get(), nullptr, nullptr);
    }
    return (cpu_ms() - start) / (2e-6 * walks * (h.faces - h.base_faces));
}

double parse(const Bytes &file, asset_format format)
{
    asset mesh;
    asset_error error;
    const double start = cpu_ms();
    expect(asset_read(file.data(), file.size(), format, nullptr, &mesh, &error),
           "a mesh file is not understood");
    const double ms = cpu_ms() - start;
    asset_free(&mesh);
    return ms;
}

/* ---- others ---- */

using Simplify = Soup (*)(const Soup &, std::size_t, double *);

double peer(const Model &m, Simplify simplify)
{
    double seconds;
    simplify(m.soup, base_faces, &seconds);
    return 1e3 * seconds;
}

Bytes draco_file(const Model &m)
{
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(static_cast<int>(m.faces()));
    const int id = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3,
                                        draco::DT_FLOAT32);
    for (std::size_t f = 0; f < m.faces(); f++)
        builder.SetAttributeValuesForFace(
            id, draco::FaceIndex(static_cast<std::uint32_t>(f)),
            &m.floats[3 * m.indices[3 * f]],
            &m.floats[3 * m.indices[3 * f + 1]],
            &m.floats[3 * m.indices[3 * f + 2]]);
    const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
    draco::Encoder encoder;
    draco::EncoderBuffer buffer;
    encoder.SetSpeedOptions(0, 0); /* -cl 10 */
    encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION,
                                     decode_bits);
    expect(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok(), "no Draco file");
    return Bytes(buffer.data(), buffer.data() + buffer.size());
}

double decode_draco(const Bytes &bytes)
{
    const double start = cpu_ms();
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char *>(bytes.data()), bytes.size());
    auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    expect(decoded.ok(), "the Draco file is damaged");
    const std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();
    const draco::PointAttribute *position =
        mesh->GetNamedAttribute(draco::GeometryAttribute::POSITION);
    std::vector<float> positions(3 * std::size_t{ mesh->num_points() });
    for (draco::PointIndex p(0); p < mesh->num_points(); ++p)
        position->GetMappedValue(p, &positions[3 * p.value()]);
    std::vector<std::uint32_t> indices;
    indices.reserve(3 * std::size_t{ mesh->num_faces() });
    for (draco::FaceIndex f(0); f < mesh->num_faces(); ++f)
        for (const draco::PointIndex &corner : mesh->face(f))
            indices.push_back(corner.value());
    return cpu_ms() - start;
}

/* ---- input ---- */

Model model_of(const std::string &name, const asset &mesh)
{
    Model m;
    m.name = name;
    m.positions.assign(mesh.positions, mesh.positions + 3 * mesh.vertex_count);
    m.floats.assign(m.positions.begin(), m.positions.end());
    m.indices.assign(mesh.indices, mesh.indices + 3 * mesh.face_count);
    return m;
}

/* Peers want each position once. */
void make_soup(Model *m)
{
    std::map<Point, std::size_t> first;
    std::vector<std::size_t> joined;
    for (std::size_t i = 0; i < m->positions.size(); i += 3) {
        const Point p(m->positions[i], m->positions[i + 1],
                      m->positions[i + 2]);
        const auto [at, fresh] = first.try_emplace(p, m->soup.points.size());
        if (fresh)
            m->soup.points.push_back(p);
        joined.push_back(at->second);
    }
    for (std::size_t i = 0; i < m->indices.size(); i += 3)
        m->soup.triangles.push_back({ joined[m->indices[i]],
                                      joined[m->indices[i + 1]],
                                      joined[m->indices[i + 2]] });
}

Bytes written(const Model &m, asset_format format)
{
    Model copy = m;
    asset mesh = {};
    asset_bytes out = {};
    asset_error error;
    mesh.positions = copy.positions.data();
    mesh.vertex_count = m.positions.size() / 3;
    mesh.floats = true;
    mesh.indices = copy.indices.data();
    mesh.face_count = m.faces();
    mesh.material_count = 1;
    expect(asset_write(&mesh, format, &out, &error), "cannot write");
    Bytes bytes(out.data, out.data + out.size);
    asset_bytes_free(&out);
    return bytes;
}

Bytes ascii_ply(const Model &m)
{
    std::ostringstream out;
    out.precision(9);
    out << "ply\nformat ascii 1.0\nelement vertex " << m.floats.size() / 3
        << "\nproperty float x\nproperty float y\nproperty float z\n"
           "element face " << m.faces()
        << "\nproperty list uchar int vertex_indices\nend_header\n";
    for (std::size_t i = 0; i < m.floats.size(); i += 3)
        out << m.floats[i] << ' ' << m.floats[i + 1] << ' ' << m.floats[i + 2]
            << '\n';
    for (std::size_t i = 0; i < m.indices.size(); i += 3)
        out << "3 " << m.indices[i] << ' ' << m.indices[i + 1] << ' '
            << m.indices[i + 2] << '\n';
    const std::string text = out.str();
    return Bytes(text.begin(), text.end());
}

/* ---- one model ---- */

double median(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 ? values[half]
                             : (values[half - 1] + values[half]) / 2;
}

/* Everybody who takes a turn, and what it took in each round. */
class Contest {
public:
    void enter(const char *name, std::function<double()> turn)
    {
        turns.push_back({ name, std::move(turn), {} });
    }
    void run(int rounds)
    {
        for (int i = 0; i < rounds; i++) {
            std::reverse(turns.begin(), turns.end());
            for (Turn &t : turns)
                t.values.push_back(t.turn());
        }
    }
    double median_of(const std::string &name) const
    {
        return median(find(name).values);
    }
    double ratio(const std::string &ours, const std::string &peer) const
    {
        const std::vector<double> &a = find(ours).values;
        const std::vector<double> &b = find(peer).values;
        std::vector<double> ratios;
        for (std::size_t i = 0; i < a.size(); i++)
            ratios.push_back(a[i] / b[i]);
        return median(ratios);
    }

private:
    struct Turn {
        std::string name;
        std::function<double()> turn;
        std::vector<double> values;
    };
    std::vector<Turn> turns;

    const Turn &find(const std::string &name) const
    {
        for (const Turn &t : turns)
            if (t.name == name)
                return t;
        throw std::runtime_error(name + " takes no part");
    }
};

/* What is compared with whom. */
const struct {
    const char *what, *ours, *peer, *must, *aim;
} comparisons[] = {
    { "contraction with log, accumulated / meshopt_simplify", "accumulated",
      "meshopt", "<3", "<1.5" },
    { "contraction with log, accumulated / OpenMesh", "accumulated",
      "openmesh", "", "" },
    { "contraction with log, memoryless + volume / meshopt_simplify",
      "memoryless", "meshopt", "<7", "<4" },
    { "contraction with log, memoryless + volume / CGAL Lindstrom-Turk",
      "memoryless", "cgal-lt", "<0.2", "" },
    { "pmesh_simplify / meshopt_simplify", "simplify", "meshopt", "<7", "<4" },
    { "pmesh_simplify / CGAL Lindstrom-Turk", "simplify", "cgal-lt", "<0.2",
      "" },
    { "whole bake / CGAL Lindstrom-Turk", "bake", "cgal-lt", "<0.5", "" },
    { "whole bake / CGAL Garland-Heckbert", "bake", "cgal-gh", "<0.5", "" },
    { "whole bake / meshopt_simplify", "bake", "meshopt", "", "<3" },
    { "whole bake, wall time of 1 thread / 2 threads", "wall-1", "wall-2",
      ">1.5", ">1.8" },
    { "decode / Draco", "decode", "draco", "<1", "<0.5" },
    { "parse OBJ / tinyobjloader", "obj", "tinyobj", "<1", "" },
    { "parse GLB / tinygltf", "glb", "tinygltf", "<1", "" },
    { "parse GLB / tinygltf and arrays of doubles and checked indices", "glb",
      "tinygltf-arrays", "", "" },
};

void line(const Model &m, const char *what, double ours, double peer,
          const char *unit, double figure, const char *must, const char *aim)
{
    std::printf("%s,%zu,\"%s\",%.4g,", m.name.c_str(), m.faces(), what, ours);
    if (peer > 0)
        std::printf("%.4g", peer);
    std::printf(",%s,%.4g,%s,%s\n", unit, figure, must, aim);
}

/* ours: so many, in this unit. */
void line(const Model &m, const char *what, double ours, const char *unit,
          const char *must, const char *aim)
{
    line(m, what, ours, 0, unit, ours, must, aim);
}

void measure(int rounds, const Model &m, const Bytes &obj)
{
    pmesh_encoder_config small = balanced(1);
    small.position_bits = decode_bits;
    const Bytes stream = encode(m, small, false).bytes;
    const Bytes drc = draco_file(m), glb = written(m, ASSET_GLB);
    const Bytes ply = written(m, ASSET_PLY), text = ascii_ply(m);
    Contest contest;

    contest.enter("accumulated", [&] {
        return contract(m, PMESH_ACCUMULATED, PMESH_SUBSET);
    });
    contest.enter("meshopt", [&] { return peer(m, simplify_meshopt); });
    contest.enter("memoryless", [&] {
        return contract(m, PMESH_MEMORYLESS, PMESH_OPTIMAL);
    });
    contest.enter("simplify", [&] { return simplify(m); });
    contest.enter("bake", [&] { return bake(m); });
    contest.enter("cgal-lt", [&] { return peer(m, simplify_lindstrom_turk); });
    contest.enter("cgal-gh", [&] {
        return peer(m, simplify_garland_heckbert);
    });
    contest.enter("openmesh", [&] { return peer(m, simplify_openmesh); });
    contest.enter("wall-1", [&] { return bake_wall(m, 1); });
    contest.enter("wall-2", [&] { return bake_wall(m, 2); });
    contest.enter("decode", [&] { return decode(stream); });
    contest.enter("draco", [&] { return decode_draco(drc); });
    contest.enter("refine", [&] { return refine(stream); });
    contest.enter("obj", [&] { return parse(obj, ASSET_OBJ); });
    contest.enter("tinyobj", [&] { return parse_tinyobj(obj); });
    contest.enter("glb", [&] { return parse(glb, ASSET_GLB); });
    contest.enter("tinygltf", [&] { return parse_tinygltf(glb); });
    contest.enter("tinygltf-arrays", [&] { return unpack_tinygltf(glb); });
    contest.enter("ply", [&] { return parse(ply, ASSET_PLY); });
    contest.enter("ascii-ply", [&] { return parse(text, ASSET_PLY); });
    contest.run(rounds);

    for (const auto &c : comparisons)
        line(m, c.what, contest.median_of(c.ours), contest.median_of(c.peer),
             "ms", contest.ratio(c.ours, c.peer), c.must, c.aim);
    const double gone = 1e-3 * static_cast<double>(m.faces() - base_faces);
    const auto rate = [&](const char *who, double amount) {
        return amount / contest.median_of(who);
    };
    const auto megabytes = [&](const char *who, const Bytes &file) {
        return rate(who, 1e-3 * static_cast<double>(file.size()));
    };
    line(m, "contraction with log, accumulated", rate("accumulated", gone),
         "M faces/s", "", ">1");
    line(m, "refine and coarsen", rate("refine", 1e3), "M faces/s", ">20", "");
    line(m, "parse OBJ", megabytes("obj", obj), "MB/s", "", ">150");
    line(m, "parse PLY, ascii", megabytes("ascii-ply", text), "MB/s", "",
         ">150");
    line(m, "parse PLY, binary", megabytes("ply", ply), "MB/s", "", "");
    line(m, "parse GLB", megabytes("glb", glb), "MB/s", "", "");

    const Stages whole = encode(m, balanced(1), false);
    const Stages part =
        encode(m, contraction(PMESH_ACCUMULATED, PMESH_SUBSET), true);
    const double faces = static_cast<double>(m.faces());
    line(m, "peak memory, contraction with log",
         static_cast<double>(part.contracted_most) / faces, "bytes/face",
         "<160", "<110");
    line(m, "peak memory, whole bake",
         static_cast<double>(whole.ledger.most) / faces, "bytes/face", "<250",
         "<160");
    line(m, "peak memory, decode",
         static_cast<double>(decode_memory(stream)) / faces, "bytes/face",
         "<60", "<40");
}

void measure_file(int rounds, const std::string &path)
{
    file_data data;
    asset mesh;
    asset_error error;
    expect(file_read(path.c_str(), FILE_LIMIT, &data, &error) &&
               asset_read(data.bytes, data.size, ASSET_OBJ, nullptr, &mesh,
                          &error), "the model cannot be read");
    const std::size_t name = path.rfind('/') + 1;
    Model m = model_of(path.substr(name, path.rfind('.') - name), mesh);
    make_soup(&m);
    asset_free(&mesh);
    measure(rounds, m, Bytes(data.bytes, data.bytes + data.size));
    file_free(&data);
}

/* ---- scaling ---- */

void scale_line(const Model &m, const char *what, double ms, std::size_t most)
{
    const double faces = static_cast<double>(m.faces());
    std::printf("%zu,%s,%.4g,", m.faces(), what, 1e3 * ms / faces);
    if (most > 0)
        std::printf("%.4g", static_cast<double>(most) / faces);
    std::printf("\n");
    std::fflush(stdout);
}

/* meshopt_simplify() from the input's own arrays: no copies of millions. */
double meshopt_ms(const Model &m)
{
    double seconds;
    simplify_meshopt(m.indices, m.floats, base_faces, &seconds);
    return 1e3 * seconds;
}

void scale(int rounds, std::uint32_t faces)
{
    asset mesh;
    expect(sample_build(faces, &mesh), "out of memory");
    const Model m = model_of("sample", mesh);
    asset_free(&mesh);
    const Stages part =
        encode(m, contraction(PMESH_ACCUMULATED, PMESH_SUBSET), true);
    const Stages whole = encode(m, balanced(1), false);
    Contest contest;

    contest.enter("accumulated", [&] {
        return contract(m, PMESH_ACCUMULATED, PMESH_SUBSET);
    });
    contest.enter("bake", [&] { return bake(m); });
    contest.enter("decode", [&] { return decode(whole.bytes); });
    contest.enter("meshopt", [&] { return meshopt_ms(m); });
    contest.run(rounds);
    scale_line(m, "contraction with log", contest.median_of("accumulated"),
               part.contracted_most);
    scale_line(m, "whole bake", contest.median_of("bake"), whole.ledger.most);
    scale_line(m, "decode", contest.median_of("decode"),
               decode_memory(whole.bytes));
    scale_line(m, "meshopt_simplify", contest.median_of("meshopt"), 0);
}

} // namespace

int main(int argc, char **argv)
{
    const int rounds = argc > 2 ? std::atoi(argv[1]) : 0;
    const bool scaling = argc > 3 && std::strcmp(argv[2], "scale") == 0;
    if (rounds < 1 || (argc > 3 && !scaling)) {
        std::cerr << "usage: bench_speed RUNS MODEL.obj\n"
                     "       bench_speed RUNS scale FACES...\n";
        return 2;
    }
    try {
        if (!scaling)
            measure_file(rounds, argv[2]);
        for (int i = 3; i < argc; i++)
            scale(rounds, static_cast<std::uint32_t>(std::atol(argv[i])));
    } catch (const std::exception &e) {
        std::cerr << "bench_speed: " << e.what() << '\n';
        return 1;
    }
    return 0;
}
