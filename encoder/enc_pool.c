/* SPDX-License-Identifier: MIT */
#include "encoder/enc_pool.h"

#include <stdbool.h>

#include "format/alloc.h"

#if defined(__unix__) || defined(__APPLE__)

#include <pthread.h>

enum { MAX_WORKERS = 64 };

typedef struct helper {
    enc_pool *pool;
    pthread_t thread;
    unsigned worker;
} helper;

/* All but the allocator is guarded by `lock`. */
struct enc_pool {
    pmesh_allocator allocator;
    pthread_mutex_t lock, memory;
    pthread_cond_t begun, ended;
    unsigned workers;
    helper helpers[MAX_WORKERS]; /* the first stands for the calling thread */
    enc_pool_work work;
    void *user;
    uint32_t parts, next; /* those from `next` on are not begun */
    uint32_t running;
    enc_pool_work aside;
    void *aside_user;
    uint32_t asked, done; /* parts */
    bool busy;            /* with the next one of them */
    bool closing;
};

/* Takes the next part, if there is one. The lock is held before and after. */
static bool work_on(enc_pool *pool, unsigned worker)
{
    if (pool->next == pool->parts)
        return false;
    const uint32_t part = pool->next++;
    pool->running++;
    pthread_mutex_unlock(&pool->lock);
    pool->work(pool->user, part, worker);
    pthread_mutex_lock(&pool->lock);
    if (--pool->running == 0 && pool->next == pool->parts)
        pthread_cond_signal(&pool->ended);
    return true;
}

/* The same of the work aside. */
static bool work_aside(enc_pool *pool, unsigned worker)
{
    if (pool->busy || pool->done == pool->asked)
        return false;
    const uint32_t part = pool->done;
    pool->busy = true;
    pthread_mutex_unlock(&pool->lock);
    pool->aside(pool->aside_user, part, worker);
    pthread_mutex_lock(&pool->lock);
    pool->busy = false;
    pool->done++;
    pthread_cond_signal(&pool->ended);
    return true;
}

static void *help(void *argument)
{
    const helper *me = argument;
    enc_pool *pool = me->pool;

    pthread_mutex_lock(&pool->lock);
    while (!pool->closing)
        if (!work_on(pool, me->worker) && !work_aside(pool, me->worker))
            pthread_cond_wait(&pool->begun, &pool->lock);
    pthread_mutex_unlock(&pool->lock);
    return NULL;
}

static bool create_locks(enc_pool *pool)
{
    if (pthread_mutex_init(&pool->lock, NULL) != 0)
        return false;
    if (pthread_mutex_init(&pool->memory, NULL) == 0) {
        if (pthread_cond_init(&pool->begun, NULL) == 0) {
            if (pthread_cond_init(&pool->ended, NULL) == 0)
                return true;
            pthread_cond_destroy(&pool->begun);
        }
        pthread_mutex_destroy(&pool->memory);
    }
    pthread_mutex_destroy(&pool->lock);
    return false;
}

enc_pool *enc_pool_create(const pmesh_allocator *allocator, uint32_t threads)
{
    enc_pool *pool;

    if (threads < 2 ||
        !(pool = pmesh_alloc_zero(allocator, 1, sizeof *pool)))
        return NULL;
    pool->allocator = *allocator;
    if (!create_locks(pool)) {
        pmesh_release(allocator, pool, 1, sizeof *pool);
        return NULL;
    }
    pool->workers = 1;
    while (pool->workers < threads && pool->workers < MAX_WORKERS) {
        helper *h = &pool->helpers[pool->workers];
        *h = (helper){ .pool = pool, .worker = pool->workers };
        if (pthread_create(&h->thread, NULL, help, h) != 0)
            break;
        pool->workers++;
    }
    if (pool->workers > 1)
        return pool;
    enc_pool_destroy(pool);
    return NULL;
}

void enc_pool_destroy(enc_pool *pool)
{
    if (!pool)
        return;
    pthread_mutex_lock(&pool->lock);
    pool->closing = true;
    pthread_cond_broadcast(&pool->begun);
    pthread_mutex_unlock(&pool->lock);
    for (unsigned i = 1; i < pool->workers; i++)
        pthread_join(pool->helpers[i].thread, NULL);
    pthread_cond_destroy(&pool->ended);
    pthread_cond_destroy(&pool->begun);
    pthread_mutex_destroy(&pool->memory);
    pthread_mutex_destroy(&pool->lock);
    const pmesh_allocator a = pool->allocator;
    pmesh_release(&a, pool, 1, sizeof *pool);
}

unsigned enc_pool_workers(const enc_pool *pool)
{
    return pool ? pool->workers : 1;
}

static void *give(void *user, size_t size)
{
    enc_pool *pool = user;

    pthread_mutex_lock(&pool->memory);
    void *block = pool->allocator.alloc(pool->allocator.user, size);
    pthread_mutex_unlock(&pool->memory);
    return block;
}

static void take(void *user, void *block, size_t size)
{
    enc_pool *pool = user;

    pthread_mutex_lock(&pool->memory);
    pool->allocator.release(pool->allocator.user, block, size);
    pthread_mutex_unlock(&pool->memory);
}

pmesh_allocator enc_pool_allocator(enc_pool *pool)
{
    return (pmesh_allocator){ give, take, pool };
}

void enc_pool_begin(enc_pool *pool, uint32_t parts, enc_pool_work work,
                    void *user)
{
    if (!pool) {
        for (uint32_t i = 0; i < parts; i++)
            work(user, i, 0);
        return;
    }
    pthread_mutex_lock(&pool->lock);
    pool->work = work;
    pool->user = user;
    pool->parts = parts;
    pool->next = 0;
    pthread_cond_broadcast(&pool->begun);
    pthread_mutex_unlock(&pool->lock);
}

void enc_pool_end(enc_pool *pool)
{
    if (!pool)
        return;
    pthread_mutex_lock(&pool->lock);
    while (work_on(pool, 0))
        ;
    while (pool->running > 0)
        pthread_cond_wait(&pool->ended, &pool->lock);
    pthread_mutex_unlock(&pool->lock);
}

void enc_pool_aside(enc_pool *pool, enc_pool_work work, void *user)
{
    pthread_mutex_lock(&pool->lock);
    pool->aside = work;
    pool->aside_user = user;
    pool->asked = pool->done = 0;
    pthread_mutex_unlock(&pool->lock);
}

void enc_pool_aside_more(enc_pool *pool)
{
    pthread_mutex_lock(&pool->lock);
    pool->asked++;
    pthread_cond_signal(&pool->begun);
    pthread_mutex_unlock(&pool->lock);
}

void enc_pool_give_way(enc_pool *pool, unsigned worker)
{
    pthread_mutex_lock(&pool->lock);
    while (work_on(pool, worker))
        ;
    pthread_mutex_unlock(&pool->lock);
}

void enc_pool_aside_end(enc_pool *pool)
{
    pthread_mutex_lock(&pool->lock);
    while (pool->done < pool->asked)
        if (!work_aside(pool, 0))
            pthread_cond_wait(&pool->ended, &pool->lock);
    pthread_mutex_unlock(&pool->lock);
}

#else /* the calling thread alone */

enc_pool *enc_pool_create(const pmesh_allocator *allocator, uint32_t threads)
{
    (void)allocator;
    (void)threads;
    return NULL;
}

void enc_pool_destroy(enc_pool *pool)
{
    (void)pool;
}

unsigned enc_pool_workers(const enc_pool *pool)
{
    (void)pool;
    return 1;
}

pmesh_allocator enc_pool_allocator(enc_pool *pool)
{
    (void)pool;
    return (pmesh_allocator){ NULL, NULL, NULL };
}

void enc_pool_begin(enc_pool *pool, uint32_t parts, enc_pool_work work,
                    void *user)
{
    (void)pool;
    for (uint32_t i = 0; i < parts; i++)
        work(user, i, 0);
}

void enc_pool_end(enc_pool *pool)
{
    (void)pool;
}

void enc_pool_aside(enc_pool *pool, enc_pool_work work, void *user)
{
    (void)pool;
    (void)work;
    (void)user;
}

void enc_pool_aside_more(enc_pool *pool)
{
    (void)pool;
}

void enc_pool_give_way(enc_pool *pool, unsigned worker)
{
    (void)pool;
    (void)worker;
}

void enc_pool_aside_end(enc_pool *pool)
{
    (void)pool;
}

#endif

void enc_pool_run(enc_pool *pool, uint32_t parts, enc_pool_work work,
                  void *user)
{
    if (parts < 2) /* nothing to share */
        pool = NULL;
    enc_pool_begin(pool, parts, work, user);
    enc_pool_end(pool);
}
