/* SPDX-License-Identifier: MIT */
#include "tools/workers.h"

#include <pthread.h>
#include <unistd.h>

enum { MOST = 64 };

typedef struct line {
    pthread_mutex_t lock; /* of `next` */
    size_t next, count;
    void (*work)(void *user, size_t i);
    void *user;
} line;

unsigned workers_available(void)
{
    const long count = sysconf(_SC_NPROCESSORS_ONLN);
    return count > 1 ? (unsigned)count : 1;
}

static void *serve(void *argument)
{
    line *l = argument;

    for (;;) {
        pthread_mutex_lock(&l->lock);
        const size_t i = l->next;
        l->next += i < l->count;
        pthread_mutex_unlock(&l->lock);
        if (i == l->count)
            return NULL;
        l->work(l->user, i);
    }
}

void workers_run(unsigned threads, size_t count,
                 void (*work)(void *user, size_t i), void *user)
{
    pthread_t thread[MOST];
    line l = { .count = count, .work = work, .user = user };
    unsigned others = 0;

    if (pthread_mutex_init(&l.lock, NULL) != 0) {
        for (size_t i = 0; i < count; i++)
            work(user, i);
        return;
    }
    while (others < MOST && others + 1 < threads && others + 1 < count &&
           pthread_create(&thread[others], NULL, serve, &l) == 0)
        others++;
    serve(&l);
    while (others > 0)
        pthread_join(thread[--others], NULL);
    pthread_mutex_destroy(&l.lock);
}
