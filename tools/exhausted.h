/* SPDX-License-Identifier: MIT */
/*
 * exhausted.h - the end of the program where memory runs out and no caller can
 * be told: C++ libraries allocate in destructors, too (nlohmann's json to walk
 * without recursion, Draco to reset its coders), and what these throw ends in
 * std::terminate().
 */
#ifndef EXHAUSTED_H
#define EXHAUSTED_H

#ifdef __cplusplus
#define EXHAUSTED_NORETURN [[noreturn]]
extern "C" {
#else
#define EXHAUSTED_NORETURN _Noreturn
#endif

/* From now on, such an end is that of exhausted_end(). */
void exhausted_catch(void);

/* Says that memory ran out, and exits with CMD_IO. No output is half written:
 * files are only while no such library is at work. */
EXHAUSTED_NORETURN void exhausted_end(void);

#ifdef __cplusplus
}
#endif
#endif
