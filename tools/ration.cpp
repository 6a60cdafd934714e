/* SPDX-License-Identifier: MIT */
#include "tools/ration.h"

#include <cstdlib>
#include <new>

namespace {

constexpr size_t always = 1 << 16; /* destructors ask for a little, too */

struct limits {
    uint64_t at_once = UINT64_MAX, left = UINT64_MAX;
    bool refused = false;
};

thread_local limits now;

/* Without a ration `left` is so much that it never runs out. */
bool take(size_t size)
{
    const bool fits = size <= now.at_once && size <= now.left;
    if (!fits && size > always) {
        now.refused = true;
        return false;
    }
    now.left -= fits ? size : 0;
    return true;
}

void *get(size_t size)
{
    return take(size) ? std::malloc(size > 0 ? size : 1) : nullptr;
}

} // namespace

ration::ration(uint64_t at_once, uint64_t in_all)
{
    now.at_once = at_once;
    now.left = in_all;
    now.refused = false;
}

ration::~ration()
{
    now = {};
}

bool ration::was_too_small() const
{
    return now.refused;
}

/* All forms but those for objects of large alignment: sanitizers have their own
 * of each, which do not call the others. */

void *operator new(size_t size)
{
    void *p = get(size);
    if (!p)
        throw std::bad_alloc();
    return p;
}

void *operator new[](size_t size)
{
    return operator new(size);
}

void *operator new(size_t size, const std::nothrow_t &) noexcept
{
    return get(size);
}

void *operator new[](size_t size, const std::nothrow_t &) noexcept
{
    return get(size);
}

void operator delete(void *p) noexcept
{
    std::free(p);
}

void operator delete[](void *p) noexcept
{
    std::free(p);
}

void operator delete(void *p, size_t) noexcept
{
    std::free(p);
}

void operator delete[](void *p, size_t) noexcept
{
    std::free(p);
}

void operator delete(void *p, const std::nothrow_t &) noexcept
{
    std::free(p);
}

void operator delete[](void *p, const std::nothrow_t &) noexcept
{
    std::free(p);
}
