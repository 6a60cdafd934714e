/* SPDX-License-Identifier: MIT */
/*
 * enc_pool.h - threads that share a loop whose turns do not depend on each
 * other.
 *
 *   enc_pool_run(pool, parts, work, user);
 *
 * calls work(user, part, worker) for each part 0 .. parts - 1, in any order and
 * in several threads at once, and returns when all are done. Worker 0 is the
 * calling thread; two parts with the same worker never overlap, so what a
 * worker writes may be its own. What comes out must not depend on who did what.
 *
 * A pool that is NULL works in the calling thread alone, part by part: so do
 * platforms without POSIX threads and processes that get no more of them.
 *
 * One thread at a time runs a pool, and work() runs none. Work does not take
 * memory, unless by enc_pool_allocator().
 */
#ifndef ENC_POOL_H
#define ENC_POOL_H

#include "format/pmesh.h"

typedef struct enc_pool enc_pool;
typedef void (*enc_pool_work)(void *user, uint32_t part, unsigned worker);

/* `threads`, the calling one included; more than 64 are not taken. NULL if
 * that is less than two, or if there is no second one to be had. */
enc_pool *enc_pool_create(const pmesh_allocator *allocator, uint32_t threads);
void enc_pool_destroy(enc_pool *pool); /* or NULL */

/* Workers are numbered below this. */
unsigned enc_pool_workers(const enc_pool *pool);

/* The pool's allocator for several threads at once; the pool is not NULL. */
pmesh_allocator enc_pool_allocator(enc_pool *pool);

void enc_pool_run(enc_pool *pool, uint32_t parts, enc_pool_work work,
                  void *user);

/* The same in two steps: the others begin, and the calling thread is free to do
 * something else before it helps them to an end. */
void enc_pool_begin(enc_pool *pool, uint32_t parts, enc_pool_work work,
                    void *user);
void enc_pool_end(enc_pool *pool);

/*
 * Work aside, of which there is one at a time: parts that are asked for one by
 * one, and done in this order, never two at once, by the others when they have
 * nothing else to do. Loops go on meanwhile; a part calls enc_pool_give_way()
 * often, which helps them, and does not care who is its worker. The pool is not
 * NULL.
 */
void enc_pool_aside(enc_pool *pool, enc_pool_work work, void *user);
void enc_pool_aside_more(enc_pool *pool);
void enc_pool_give_way(enc_pool *pool, unsigned worker);
void enc_pool_aside_end(enc_pool *pool); /* when all are done */

#endif
