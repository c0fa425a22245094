/* tests/windows.h - what tests use of POSIX and mingw-w64 lacks. Included before each test that is
 * built for Windows. */
#ifndef MAROTTE_TESTS_WINDOWS_H
#define MAROTTE_TESTS_WINDOWS_H
#include "base/os.h"

#include <stdlib.h>

static inline int setenv(const char *name, const char *value, int replace)
{
    return replace || !getenv(name) ? _putenv_s(name, value) : 0;
}

static inline int unsetenv(const char *name)
{
    return _putenv_s(name, "");
}

static inline char *mkdtemp(char *path)
{
    return os_make_new_folder(path) == 0 ? path : NULL;
}

#define mkdir(path, mode) os_make_folder(path)

#endif
