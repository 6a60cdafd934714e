/* SPDX-License-Identifier: MIT */
/*
 * ration.h - a limit on the memory that a C++ library may ask for.
 *
 * Draco's decoder believes some counts of a stream: 827 bytes made it take
 * 268 MB for 2^31 bits that are not there, and read them for 6 s. Its requests
 * go through operator new, which this replaces in the program: within a ration
 * it refuses those that a mesh of that size cannot need, and they end like
 * exhausted memory, by std::bad_alloc.
 */
#ifndef RATION_H
#define RATION_H

#include <cstddef>
#include <cstdint>

/* For the thread that makes it, as long as it lives; at most one at a time. */
class ration {
public:
    /* Bytes of a single request, and of all together; what is given back does
     * not count. */
    ration(uint64_t at_once, uint64_t in_all);
    ~ration();
    ration(const ration &) = delete;
    ration &operator=(const ration &) = delete;
    bool was_too_small() const; /* something was refused */
};

#endif
