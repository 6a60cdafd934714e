/* SPDX-License-Identifier: MIT */
/* parsers.h - other programs' parsers, and what measures them and ours. */
#ifndef PARSERS_H
#define PARSERS_H

#include <cstdint>
#include <ctime>
#include <stdexcept>
#include <vector>

using Bytes = std::vector<std::uint8_t>;

inline void expect(bool good, const char *what)
{
    if (!good)
        throw std::runtime_error(what);
}

inline double clock_ms(clockid_t clock)
{
    timespec now;
    clock_gettime(clock, &now);
    return 1e3 * static_cast<double>(now.tv_sec) +
           1e-6 * static_cast<double>(now.tv_nsec);
}

inline double cpu_ms()
{
    return clock_ms(CLOCK_PROCESS_CPUTIME_ID);
}

/* Milliseconds that reading a file takes. */
double parse_tinyobj(const Bytes &file);
/* The container, its JSON and a copy of its bytes. */
double parse_tinygltf(const Bytes &file);
/* And then what its user does: the arrays that ours gives, checked. */
double unpack_tinygltf(const Bytes &file);

#endif
