// SPDX-License-Identifier: MIT
// A link of a given speed, simulated: a stream that hands its bytes on no
// faster. `speed` is called for each piece, so it may change on the way.
const TICK = 40; // milliseconds

export function throttle(stream, speed) {
    return stream.pipeThrough(new TransformStream({
        async transform(chunk, control) {
            for (let at = 0; at < chunk.length;) {
                const rate = speed(); // bits per second, 0: no limit
                const size = rate ? Math.max(1, Math.round(rate / 8000 * TICK)) :
                    chunk.length;
                const part = chunk.subarray(at, at + size);
                at += part.length;
                control.enqueue(part);
                if (rate)
                    await wait(TICK * part.length / size);
            }
        },
    }, { highWaterMark: 1 }, { highWaterMark: 0 }));
}

export function wait(milliseconds) {
    return new Promise((done) => setTimeout(done, milliseconds));
}

// Lets the page draw.
export function frame() {
    return new Promise((done) => {
        requestAnimationFrame(done);
        setTimeout(done, 100); // a page in the background draws nothing
    });
}
