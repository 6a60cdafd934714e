/* SPDX-License-Identifier: MIT */
/*
 * test.h - the unit test harness.
 *
 *   TEST(decoder_accepts_null_on_destroy)
 *   {
 *       pmesh_decoder_destroy(NULL);
 *       CHECK(still_here());
 *   }
 *
 * Tests register themselves; main.c runs those whose name or file contains the
 * program's argument. A failed CHECK ends its test, from helpers too, and what
 * the test holds is not freed then.
 */
#ifndef TEST_H
#define TEST_H

typedef struct test_case {
    const char *name, *file;
    void (*run)(void);
    struct test_case *next;
} test_case;

void test_register(test_case *test);

_Noreturn void test_fail(const char *file, int line, const char *condition);

#define TEST(title)                                                         \
    static void test_##title(void);                                         \
    __attribute__((constructor)) static void test_register_##title(void)    \
    {                                                                       \
        static test_case test = { #title, __FILE__, test_##title, 0 };      \
        test_register(&test);                                               \
    }                                                                       \
    static void test_##title(void)

#define CHECK(condition)                                                    \
    do {                                                                    \
        if (!(condition))                                                   \
            test_fail(__FILE__, __LINE__, #condition);                      \
    } while (0)

#endif
