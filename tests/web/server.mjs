// SPDX-License-Identifier: MIT
// A web server on loopback that serves one body, as badly as it is told:
//
//   etag         of the body (null: none)    lastModified   likewise
//   ranges       false: answers 200 to a Range request
//   length       false: no Content-Length
//   gzip         true: compresses, with a weak ETag
//   rate         bytes per millisecond (0: at once)
//   breakAfter   closes the connection after so many bytes, once
//   files        { "/path": body }, besides the one body of any other path
import { createServer } from "node:http";
import { gzipSync } from "node:zlib";

const TYPES = { "/": "text/html", html: "text/html", js: "text/javascript" };

export async function serve(body, options = {}) {
    const state = {
        body, etag: '"1"', lastModified: null, ranges: true, length: true,
        gzip: false, rate: 0, breakAfter: 0, files: {}, ...options,
        log: [], sent: 0,
    };
    const server = createServer((request, response) =>
        answer(state, request, response));
    await new Promise((done) => server.listen(0, "127.0.0.1", done));
    state.url = `http://127.0.0.1:${server.address().port}/mesh.pmesh`;
    state.close = () => {
        server.closeAllConnections();
        return new Promise((done) => server.close(done));
    };
    return state;
}

function answer(state, request, response) {
    const file = state.files[request.url];
    if (file !== undefined) {
        response.setHeader("Content-Type",
            TYPES[request.url.split(".").pop()] ?? "application/octet-stream");
        response.end(file);
        return;
    }
    const range = /^bytes=(\d+)-$/.exec(request.headers.range ?? "");
    const condition = request.headers["if-range"];
    state.log.push({ range: request.headers.range, condition });
    let { body } = state, etag = state.etag;
    if (state.gzip) {
        body = gzipSync(body);
        etag = etag && `W/${etag}`;
        response.setHeader("Content-Encoding", "gzip");
    }
    if (etag)
        response.setHeader("ETag", etag);
    if (state.lastModified)
        response.setHeader("Last-Modified", state.lastModified);
    const fits = !condition || condition === (etag ?? state.lastModified);
    const first = range && state.ranges && fits ? Number(range[1]) : 0;
    if (range && state.ranges && fits) {
        response.statusCode = first < body.length ? 206 : 416;
        response.setHeader("Content-Range", first < body.length ?
            `bytes ${first}-${body.length - 1}/${body.length}` :
            `bytes */${body.length}`);
    }
    if (response.statusCode === 416) {
        response.end();
        return;
    }
    const rest = body.subarray(first);
    if (state.length)
        response.setHeader("Content-Length", rest.length);
    send(state, response, rest);
}

function send(state, response, rest) {
    const stop = state.breakAfter || Infinity;
    let at = 0;
    state.breakAfter = 0;
    const step = () => {
        const size = state.rate ? Math.max(1, Math.round(state.rate * 4)) : 4096;
        const part = rest.subarray(at, Math.min(at + size, stop));
        if (response.destroyed)
            return;
        at += part.length;
        state.sent += part.length;
        const more = () => {
            if (at >= stop)
                response.destroy();
            else if (at >= rest.length)
                response.end();
            else
                setTimeout(step, state.rate ? 4 : 0);
        };
        response.write(part, more);
    };
    step();
}
