/* SPDX-License-Identifier: MIT */
#include "encoder/enc_pipe.h"

#include <stdbool.h>
#include <string.h>

#include "format/alloc.h"

#if defined(__unix__) || defined(__APPLE__)

#include <pthread.h>

enum {
    SIZE = 1 << 20,    /* a reader half as fast falls behind by that much in a
                          block of 64 KiB */
    PORTION = 1 << 17, /* handed over at once: the reader is soon done, and
                          waking it takes the writer 10 us */
    HEAD = 8           /* before an entry: its size with this; 0: go on at the
                          start */
};

/* Bytes are counted from the first on; byte n is at n % SIZE. */
struct enc_pipe {
    pmesh_allocator allocator;
    pthread_mutex_t lock;
    pthread_cond_t moved;
    uint64_t filled, freed; /* guarded by the lock, */
    bool closed;            /* which changes wake the other by */

    uint64_t write, told, free; /* the writer's: of `filled`, of `freed` */
    uint64_t read, left, full;  /* the reader's, likewise */
    _Alignas(16) uint8_t data[SIZE];
};

enc_pipe *enc_pipe_create(const pmesh_allocator *allocator)
{
    enc_pipe *p = pmesh_alloc(allocator, 1, sizeof *p);

    if (!p)
        return NULL;
    p->allocator = *allocator;
    if (pthread_mutex_init(&p->lock, NULL) == 0) {
        if (pthread_cond_init(&p->moved, NULL) == 0) {
            enc_pipe_open(p);
            return p;
        }
        pthread_mutex_destroy(&p->lock);
    }
    pmesh_release(allocator, p, 1, sizeof *p);
    return NULL;
}

void enc_pipe_destroy(enc_pipe *p)
{
    if (!p)
        return;
    pthread_cond_destroy(&p->moved);
    pthread_mutex_destroy(&p->lock);
    const pmesh_allocator a = p->allocator;
    pmesh_release(&a, p, 1, sizeof *p);
}

void enc_pipe_open(enc_pipe *p)
{
    p->filled = p->freed = 0;
    p->write = p->told = p->free = 0;
    p->read = p->left = p->full = 0;
    p->closed = false;
}

/* ---- the writer ---------------------------------------------------------- */

static void hand_over(enc_pipe *p, bool last)
{
    pthread_mutex_lock(&p->lock);
    p->filled = p->told = p->write;
    p->closed = last;
    pthread_cond_signal(&p->moved);
    pthread_mutex_unlock(&p->lock);
}

/* Until `need` more bytes are free. What was written is handed over before, so
 * that the reader comes to its end and frees all. */
static void wait_for_room(enc_pipe *p, uint64_t need)
{
    hand_over(p, false);
    pthread_mutex_lock(&p->lock);
    while (p->write + need - p->freed > SIZE)
        pthread_cond_wait(&p->moved, &p->lock);
    p->free = p->freed;
    pthread_mutex_unlock(&p->lock);
}

static void put_size(enc_pipe *p, uint64_t size)
{
    memcpy(p->data + p->write % SIZE, &size, HEAD);
}

void *enc_pipe_room(enc_pipe *p, size_t size)
{
    const uint64_t whole = HEAD + (size + HEAD - 1) / HEAD * HEAD;
    const uint64_t left = SIZE - p->write % SIZE;
    const uint64_t need = left < whole ? left + whole : whole;

    if (p->write - p->told > PORTION)
        hand_over(p, false);
    if (p->write + need - p->free > SIZE)
        wait_for_room(p, need);
    if (left < whole) {
        put_size(p, 0);
        p->write += left;
    }
    put_size(p, whole);
    uint8_t *room = p->data + p->write % SIZE + HEAD;
    p->write += whole;
    return room;
}

void enc_pipe_flush(enc_pipe *p)
{
    hand_over(p, false);
}

void enc_pipe_close(enc_pipe *p)
{
    hand_over(p, true);
}

/* ---- the reader ---------------------------------------------------------- */

/* Gives back what was read and waits for more; false if none will come. */
static bool wait_for_more(enc_pipe *p)
{
    pthread_mutex_lock(&p->lock);
    p->freed = p->left = p->read;
    pthread_cond_signal(&p->moved);
    while (p->filled == p->read && !p->closed)
        pthread_cond_wait(&p->moved, &p->lock);
    p->full = p->filled;
    pthread_mutex_unlock(&p->lock);
    return p->full != p->read;
}

static void give_back(enc_pipe *p)
{
    pthread_mutex_lock(&p->lock);
    p->freed = p->left = p->read;
    pthread_cond_signal(&p->moved);
    pthread_mutex_unlock(&p->lock);
}

const void *enc_pipe_next(enc_pipe *p)
{
    uint64_t whole;

    if (p->read == p->full && !wait_for_more(p))
        return NULL;
    if (p->read - p->left > SIZE / 8)
        give_back(p);
    memcpy(&whole, p->data + p->read % SIZE, HEAD);
    if (whole == 0) {
        p->read += SIZE - p->read % SIZE;
        memcpy(&whole, p->data, HEAD);
    }
    const uint8_t *entry = p->data + p->read % SIZE + HEAD;
    p->read += whole;
    return entry;
}

#else

enc_pipe *enc_pipe_create(const pmesh_allocator *allocator)
{
    (void)allocator;
    return NULL;
}

void enc_pipe_destroy(enc_pipe *pipe)
{
    (void)pipe;
}

void enc_pipe_open(enc_pipe *pipe)
{
    (void)pipe;
}

void *enc_pipe_room(enc_pipe *pipe, size_t size)
{
    (void)pipe;
    (void)size;
    return NULL;
}

void enc_pipe_flush(enc_pipe *pipe)
{
    (void)pipe;
}

void enc_pipe_close(enc_pipe *pipe)
{
    (void)pipe;
}

const void *enc_pipe_next(enc_pipe *pipe)
{
    (void)pipe;
    return NULL;
}

#endif
