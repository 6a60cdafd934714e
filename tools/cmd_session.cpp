/* SPDX-License-Identifier: MIT */
/*
 * cmd_session.cpp - a session without a window: simplifies back and forth, and
 * takes guidance at any level, by a script.
 */
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include "encoder/pmesh_session.h"

extern "C" {
#include "tools/args.h"
#include "tools/cmd.h"
#include "tools/file.h"
#include "tools/load.h"
#include "tools/report.h"
#include "tools/topology.h"
}

namespace {

struct options {
    const char *unused;
    bool quiet;
};

const args_option option_table[] = {
    { "quiet", 'q', ARGS_FLAG, nullptr, 0, 0, offsetof(options, quiet),
      "print no log" },
};

const args_command command = {
    "session",
    "Simplifies back and forth by a script, guided at any level.",
    "SCRIPT [options]",
    option_table,
    sizeof option_table / sizeof *option_table,
    "SCRIPT (\"-\": standard input) has one action a line; \"#\" begins a "
    "comment. WHERE is\n\"sphere X Y Z R\", \"box X Y Z X Y Z\", \"vertices N "
    "N ...\" or \"all\", of what is there\nat the time; numbers are those of "
    "the mesh's file.\n\n"
    "  load FILE               a mesh; first of all\n"
    "  faces N                 contracts or expands\n"
    "  weight W WHERE          paints, 0 to 1\n"
    "  point|plane|contour [IMPORTANCE] WHERE\n"
    "  undo                    takes the last of these back\n"
    "  cut E WHERE             writes next the cut with error E there, and as\n"
    "                          it is elsewhere\n"
    "  save FILE               writes a mesh file\n\n"
    "Each action is printed with the faces and the error it leads to.\n\n"
    "  pmesh session walk.txt, where walk.txt holds:\n\n"
    "  load cow.obj\n"
    "  faces 500\n"
    "  weight 1 sphere -3.2 1.6 0 2   # the head, as it looks now\n"
    "  faces 5000\n"
    "  faces 500\n"
    "  save cow500.obj\n",
};

struct failure {
    int code;
    std::string what;
};

[[noreturn]] void fail(int code, const std::string &what)
{
    throw failure{ code, what };
}

class script {
public:
    explicit script(bool quiet) : quiet(quiet) {}
    ~script()
    {
        pmesh_session_destroy(session);
        asset_free(&mesh);
    }

    void line(const std::string &text);

private:
    bool quiet;
    asset mesh = {};
    std::vector<uint32_t> indices; /* one number for each place */
    pmesh_session *session = nullptr;
    std::vector<double> thresholds; /* of a cut to be saved */

    void load(const std::string &path);
    void save(const std::string &path);
    void cut(double error, const std::vector<uint32_t> &where);
    std::vector<uint32_t> where(std::istringstream &in) const;
    void check(pmesh_status status) const;
    void tell(const std::string &text) const;
};

double number(std::istringstream &in)
{
    double value;
    if (!(in >> value) || !std::isfinite(value))
        fail(CMD_USAGE, "a number is expected");
    return value;
}

void script::check(pmesh_status status) const
{
    if (status == PMESH_E_MEMORY)
        fail(CMD_IO, "out of memory");
    if (status != PMESH_OK)
        fail(CMD_USAGE, pmesh_status_text(status));
}

void script::load(const std::string &path)
{
    asset_error error;
    if (session)
        fail(CMD_USAGE, "a mesh is loaded already");
    const int code = load_mesh(path.c_str(), &mesh, &error);
    if (code != CMD_DONE)
        fail(code, path + ": " + error.what);
    uint32_t *joined = topology_join(&mesh);
    if (!joined)
        fail(CMD_IO, "out of memory");
    for (size_t c = 0; c < 3 * mesh.face_count; c++)
        indices.push_back(joined[mesh.indices[c]]);
    free(joined);
    pmesh_mesh_input input = {};
    input.positions = mesh.positions;
    input.vertex_count = mesh.vertex_count;
    input.indices = indices.data();
    input.face_count = mesh.face_count;
    const pmesh_status status =
        pmesh_session_create(&session, &input, nullptr);
    if (status != PMESH_OK)
        fail(status == PMESH_E_MEMORY ? CMD_IO : CMD_ASSET,
             path + ": " + pmesh_status_text(status));
}

/* Vertices of what is there now; regions by where they are now. */
std::vector<uint32_t> script::where(std::istringstream &in) const
{
    std::vector<uint32_t> found;
    std::string kind;
    std::vector<bool> used(mesh.vertex_count);
    in >> kind;

    if (kind == "vertices") {
        uint32_t v;
        while (in >> v) { /* up to the end of the line */
            if (v >= mesh.vertex_count)
                fail(CMD_USAGE, "vertex " + std::to_string(v) + ", there are " +
                                    std::to_string(mesh.vertex_count));
            found.push_back(v);
        }
        if (!in.eof())
            fail(CMD_USAGE, "vertex numbers are expected");
        return found;
    }
    double n[6] = {};
    const int count = kind == "sphere" ? 4 : kind == "box" ? 6 : 0;
    if (count == 0 && kind != "all")
        fail(CMD_USAGE, "sphere, box, vertices or all is expected");
    for (int i = 0; i < count; i++)
        n[i] = number(in);
    if (std::string rest; in >> rest)
        fail(CMD_USAGE, "'" + rest.substr(0, 40) + "' is too much");
    std::vector<uint32_t> now(3 * pmesh_session_faces(session));
    pmesh_session_indices(session, now.data());
    for (const uint32_t v : now)
        used[v] = true;
    for (uint32_t v = 0; v < mesh.vertex_count; v++) {
        pmesh_session_node node;
        if (!used[v])
            continue;
        pmesh_session_look(session, v, &node);
        const double *p = node.position;
        bool inside = true;
        double square = 0;
        for (int k = 0; k < 3; k++) {
            inside = inside && (count != 6 || (p[k] >= n[k] && p[k] <= n[3 + k]));
            square += (p[k] - n[k]) * (p[k] - n[k]);
        }
        if (inside && (count != 4 || square <= n[3] * n[3]))
            found.push_back(v);
    }
    return found;
}

void script::cut(double error, const std::vector<uint32_t> &where)
{
    size_t count;
    const pmesh_session_step *log = pmesh_session_log(session, &count);
    std::vector<bool> inside(mesh.vertex_count);

    if (thresholds.empty())
        thresholds.assign(mesh.vertex_count,
                          count > 0 ? log[count - 1].error : 0);
    for (const uint32_t v : where)
        inside[pmesh_session_vertex(session, v)] = true;
    for (const uint32_t v : indices)
        if (inside[pmesh_session_vertex(session, v)])
            thresholds[v] = error;
}

void script::save(const std::string &path)
{
    asset out = {};
    asset_bytes bytes = {};
    asset_error error;
    size_t forced = 0;
    std::vector<uint32_t> faces;
    std::vector<double> positions(3 * mesh.vertex_count);
    const asset_format format = asset_format_of(path.c_str());

    if (format == ASSET_UNKNOWN)
        fail(CMD_USAGE, "'" + path + "' names no mesh format");
    if (thresholds.empty()) {
        faces.resize(3 * pmesh_session_faces(session));
        pmesh_session_indices(session, faces.data());
        for (const uint32_t v : faces) {
            pmesh_session_node node;
            pmesh_session_look(session, v, &node);
            memcpy(&positions[3 * size_t{ v }], node.position,
                   sizeof node.position);
        }
    } else {
        std::vector<uint32_t> into(mesh.vertex_count);
        check(pmesh_session_cut(session, thresholds.data(), into.data(),
                                positions.data(), &forced));
        for (size_t f = 0; f < mesh.face_count; f++) {
            const uint32_t v[3] = { into[indices[3 * f]],
                                    into[indices[3 * f + 1]],
                                    into[indices[3 * f + 2]] };
            if (v[0] != v[1] && v[1] != v[2] && v[2] != v[0])
                faces.insert(faces.end(), v, v + 3);
        }
    }
    /* Vertices in use, in order of appearance. */
    std::vector<uint32_t> renumbered(mesh.vertex_count, UINT32_MAX);
    std::vector<double> used;
    for (uint32_t &v : faces) {
        if (renumbered[v] == UINT32_MAX) {
            renumbered[v] = static_cast<uint32_t>(used.size() / 3);
            used.insert(used.end(), &positions[3 * size_t{ v }],
                        &positions[3 * size_t{ v }] + 3);
        }
        v = renumbered[v];
    }
    out.positions = used.data();
    out.vertex_count = used.size() / 3;
    out.indices = faces.data();
    out.face_count = faces.size() / 3;
    out.material_count = 1;
    const bool ok = asset_write(&out, format, &bytes, &error) &&
                    file_write(path.c_str(), bytes.data, bytes.size, &error);
    asset_bytes_free(&bytes);
    if (!ok)
        fail(CMD_IO, path + ": " + error.what);
    if (!quiet && !thresholds.empty())
        printf("%-28s %9zu faces  %zu contractions out of order\n",
               ("save " + path).c_str(), out.face_count, forced);
    else if (!quiet)
        printf("%-28s %9zu faces\n", ("save " + path).c_str(), out.face_count);
    thresholds.clear();
}

void script::tell(const std::string &text) const
{
    size_t count;
    const pmesh_session_step *log = pmesh_session_log(session, &count);
    if (!quiet)
        printf("%-28s %9zu faces  error %.4g\n", text.substr(0, 28).c_str(),
               pmesh_session_faces(session),
               count > 0 ? log[count - 1].error : 0.0);
}

void script::line(const std::string &text)
{
    std::istringstream in(text.substr(0, text.find('#')));
    std::string word;

    if (!(in >> word))
        return;
    if (word == "load" || word == "save") {
        std::string path;
        std::getline(in >> std::ws, path);
        path.erase(path.find_last_not_of(" \t\r") + 1);
        if (path.empty())
            fail(CMD_USAGE, "a file is expected");
        if (word == "load")
            load(path);
        else if (session)
            save(path);
        if (word == "save" && session)
            return;
    }
    if (!session)
        fail(CMD_USAGE, "load comes first");
    if (word == "faces") {
        const double n = number(in);
        if (!(n >= 0 && n < 4e9))
            fail(CMD_USAGE, "a number of faces is expected");
        if (std::string rest; in >> rest)
            fail(CMD_USAGE, "'" + rest.substr(0, 40) + "' is too much");
        check(pmesh_session_move(session, static_cast<size_t>(n)));
    } else if (word == "weight") {
        const double weight = number(in);
        const std::vector<uint32_t> at = where(in);
        check(pmesh_session_weigh(session, at.data(), at.size(), weight));
    } else if (word == "point" || word == "plane" || word == "contour") {
        double importance = 0;
        const std::streampos before = in.tellg();
        if (!(in >> importance)) {
            in.clear();
            in.seekg(before);
            importance = 0;
        }
        const std::vector<uint32_t> at = where(in);
        check(pmesh_session_constrain(session,
                                      word == "point"   ? PMESH_POINT
                                      : word == "plane" ? PMESH_PLANE
                                                        : PMESH_CONTOUR,
                                      at.data(), at.size(), importance));
    } else if (word == "undo") {
        if (pmesh_session_undo(session) != PMESH_OK)
            fail(CMD_USAGE, "there is nothing to undo");
    } else if (word == "cut") {
        const double error = number(in);
        cut(error, where(in));
    } else if (word != "load") {
        fail(CMD_USAGE, "unknown action '" + word.substr(0, 40) + "'");
    }
    tell(text);
}

} // namespace

extern "C" int cmd_session(int argc, char **argv)
{
    options o = {};
    int operands;
    file_data data;
    asset_error error;

    const args_result result = args_parse(&command, argc, argv, &o, &operands);
    if (result != ARGS_RUN)
        return result == ARGS_HELP ? CMD_DONE : CMD_USAGE;
    if (operands != 1) {
        args_complain(&command, "one SCRIPT is needed");
        return CMD_USAGE;
    }
    const char *name = file_input_name(argv[0]);
    if (!file_read(argv[0], 1 << 26, &data, &error)) {
        report_asset_error(name, &error);
        return CMD_IO;
    }
    std::istringstream lines(
        std::string(reinterpret_cast<char *>(data.bytes), data.size));
    file_free(&data);
    size_t number = 0;
    int code = CMD_DONE;
    try {
        script run(o.quiet);
        for (std::string text; std::getline(lines, text);) {
            number++;
            run.line(text);
        }
    } catch (const failure &f) {
        char where[32];
        snprintf(where, sizeof where, "line %zu", number);
        report_error(name, where, "%s", f.what.c_str());
        code = f.code;
    } catch (const std::bad_alloc &) {
        report_error(name, nullptr, "out of memory");
        code = CMD_IO;
    }
    return code;
}
