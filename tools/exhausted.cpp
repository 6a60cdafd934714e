/* SPDX-License-Identifier: MIT */
#include "tools/exhausted.h"

#include <cstdlib>
#include <exception>
#include <new>

#include <unistd.h>

#include "tools/cmd.h"

namespace {

[[noreturn]] void on_terminate()
{
    try {
        throw; /* what nobody caught */
    } catch (const std::bad_alloc &) {
        exhausted_end();
    } catch (...) {
        std::abort();
    }
}

} // namespace

void exhausted_catch()
{
    std::set_terminate(on_terminate);
}

void exhausted_end()
{
    static const char text[] = "pmesh: out of memory\n";
    const ssize_t put = write(STDERR_FILENO, text, sizeof text - 1);
    static_cast<void>(put);
    _exit(CMD_IO);
}
