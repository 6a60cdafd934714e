/* SPDX-License-Identifier: MIT */
#include "tests/unit/test.h"

#include <setjmp.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static struct {
    test_case *first, **end, *running;
    jmp_buf escape;
} suite;

void test_register(test_case *test)
{
    if (!suite.end)
        suite.end = &suite.first;
    *suite.end = test;
    suite.end = &test->next;
}

void test_fail(const char *file, int line, const char *condition)
{
    printf("%s:%d: %s: failed: %s\n", file, line, suite.running->name,
           condition);
    longjmp(suite.escape, 1);
}

static bool passes(test_case *test)
{
    suite.running = test;
    if (setjmp(suite.escape))
        return false;
    test->run();
    return true;
}

int main(int argc, char **argv)
{
    const char *filter = argc > 1 ? argv[1] : "";
    unsigned passed = 0, failed = 0;

    setvbuf(stdout, NULL, _IOLBF, 0); /* nothing is lost when a test crashes */
    for (test_case *test = suite.first; test; test = test->next) {
        if (!strstr(test->name, filter) && !strstr(test->file, filter))
            continue;
        if (passes(test))
            passed++;
        else
            failed++;
    }
    printf("%u passed, %u failed\n", passed, failed);
    return failed > 0 || passed == 0;
}
