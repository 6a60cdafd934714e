/* SPDX-License-Identifier: MIT */
/*
 * bench_decode - decoding in this process: .pmesh against Draco.
 *
 *   bench_decode PAIRS FILE.pmesh FILE.drc
 *
 * Each pair decodes both files once, from bytes in memory to an index buffer
 * (32 bits) and a buffer of float positions, everything allocated anew. Pairs
 * begin with either in turn, so that a machine that slows down is unfair to
 * neither; a first pair warms up and does not count. Prints one line of CSV:
 *
 *   faces,splits,pmesh_ms,draco_ms,ratio,msplits_per_s
 *
 * Times are medians of CPU time of this thread, ratio is the median of the
 * pairs' own ratios, pmesh / Draco.
 */
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>
#include <iostream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <draco/compression/decode.h>

#include "decoder/pmesh_decode.h"

namespace {

using Bytes = std::vector<char>;

struct Buffers {
    std::vector<float> positions;
    std::vector<std::uint32_t> indices;
    std::size_t splits = 0; /* of a .pmesh */
};

Bytes read(const std::string &path)
{
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw std::runtime_error(path + ": cannot be read");
    return Bytes(std::istreambuf_iterator<char>(file), {});
}

void expect(bool good, const char *what)
{
    if (!good)
        throw std::runtime_error(what);
}

Buffers decode_pmesh(const Bytes &bytes)
{
    pmesh_decoder *created;
    expect(pmesh_decoder_create(&created, nullptr) == PMESH_OK, "no decoder");
    const std::unique_ptr<pmesh_decoder, void (*)(pmesh_decoder *)> dec(
        created, pmesh_decoder_destroy);
    pmesh_view view;
    pmesh_header header;

    expect(pmesh_decoder_feed(dec.get(), bytes.data(), bytes.size()) ==
               PMESH_OK, "the .pmesh file is damaged or cut off");
    expect(pmesh_decoder_refine(dec.get(), nullptr, nullptr) == PMESH_OK &&
               pmesh_decoder_mesh(dec.get(), &view) == PMESH_OK &&
               pmesh_decoder_header(dec.get(), &header) == PMESH_OK,
           "the .pmesh file has no mesh");
    Buffers out;
    out.splits = header.mesh_vertices - header.base_mesh_vertices;
    out.indices.assign(view.indices,
                       view.indices + 3 * std::size_t{ view.face_count });
    out.positions.resize(3 * std::size_t{ view.vertex_count });
    expect(pmesh_decoder_copy_positions(dec.get(), out.positions.data(), 0) ==
               PMESH_OK, "no positions");
    return out;
}

Buffers decode_draco(const Bytes &bytes)
{
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    expect(decoded.ok(), "the Draco file is damaged");
    const std::unique_ptr<draco::Mesh> mesh = std::move(decoded).value();
    const draco::PointAttribute *position =
        mesh->GetNamedAttribute(draco::GeometryAttribute::POSITION);
    expect(position && position->data_type() == draco::DT_FLOAT32,
           "the Draco file has no float positions");

    Buffers out;
    out.positions.resize(3 * std::size_t{ mesh->num_points() });
    for (draco::PointIndex p(0); p < mesh->num_points(); ++p)
        position->GetMappedValue(p, &out.positions[3 * p.value()]);
    out.indices.resize(3 * std::size_t{ mesh->num_faces() });
    for (draco::FaceIndex f(0); f < mesh->num_faces(); ++f)
        for (int k = 0; k < 3; k++)
            out.indices[3 * f.value() + static_cast<std::size_t>(k)] =
                mesh->face(f)[static_cast<std::size_t>(k)].value();
    return out;
}

double cpu_ms()
{
    timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) +
           1e-6 * static_cast<double>(now.tv_nsec);
}

/* The buffers live on: freeing what both must hand over is not counted. */
double clock_of(Buffers (*decode)(const Bytes &), const Bytes &bytes,
                Buffers *out)
{
    const double start = cpu_ms();
    Buffers decoded = decode(bytes);
    const double ms = cpu_ms() - start;
    *out = std::move(decoded);
    return ms;
}

double median(std::vector<double> values)
{
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 ? values[half]
                             : (values[half - 1] + values[half]) / 2;
}

void run(int pairs, const Bytes &pmesh_file, const Bytes &draco_file)
{
    std::vector<double> ours, theirs, ratio;
    Buffers mine, peer;

    for (int i = -1; i < pairs; i++) {
        double a = 0, b = 0;
        if (i % 2 == 0)
            a = clock_of(decode_pmesh, pmesh_file, &mine);
        b = clock_of(decode_draco, draco_file, &peer);
        if (i % 2 != 0)
            a = clock_of(decode_pmesh, pmesh_file, &mine);
        if (i < 0)
            continue;
        ours.push_back(a);
        theirs.push_back(b);
        ratio.push_back(a / b);
    }
    if (mine.indices.size() != peer.indices.size())
        std::cerr << "bench_decode: " << mine.indices.size() / 3 << " faces, "
                  << "but Draco has " << peer.indices.size() / 3 << '\n';
    std::printf("%zu,%zu,%.3f,%.3f,%.3f,%.3f\n", mine.indices.size() / 3,
                mine.splits, median(ours), median(theirs), median(ratio),
                static_cast<double>(mine.splits) / median(ours) / 1e3);
}

} // namespace

int main(int argc, char **argv)
{
    const int pairs = argc == 4 ? std::atoi(argv[1]) : 0;
    if (pairs < 1) {
        std::cerr << "usage: bench_decode PAIRS FILE.pmesh FILE.drc\n";
        return 2;
    }
    try {
        run(pairs, read(argv[2]), read(argv[3]));
    } catch (const std::exception &e) {
        std::cerr << "bench_decode: " << e.what() << '\n';
        return 1;
    }
    return 0;
}
