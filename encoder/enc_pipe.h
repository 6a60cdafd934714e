/* SPDX-License-Identifier: MIT */
/*
 * enc_pipe.h - what one thread tells another: entries of some bytes, in order.
 *
 * The writer:                            The reader:
 *
 *   memcpy(enc_pipe_room(p, n), it, n);    while ((it = enc_pipe_next(p)))
 *   ...                                        ...
 *   enc_pipe_close(p);
 *
 * The reader gets what is written by portions; the writer waits if it is far
 * ahead. Behind the end the pipe is opened again for the next lot. A reader
 * that comes behind the close does not wait, and may be the writer's thread.
 */
#ifndef ENC_PIPE_H
#define ENC_PIPE_H

#include "format/pmesh.h"

enum { ENC_PIPE_MOST = 4096 }; /* bytes of an entry */

typedef struct enc_pipe enc_pipe;

/* NULL if memory is out, or where there are no threads. */
enc_pipe *enc_pipe_create(const pmesh_allocator *allocator);
void enc_pipe_destroy(enc_pipe *pipe); /* or NULL */

void enc_pipe_open(enc_pipe *pipe);

/* Room for an entry, aligned for any number, to be filled before the next
 * call. */
void *enc_pipe_room(enc_pipe *pipe, size_t size);

/* The reader need not wait for more to get what is written so far. */
void enc_pipe_flush(enc_pipe *pipe);

/* No more entries. */
void enc_pipe_close(enc_pipe *pipe);

/* The next entry, valid until the next call; NULL behind the last one. */
const void *enc_pipe_next(enc_pipe *pipe);

#endif
