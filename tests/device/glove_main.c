/* glove_emulator [--option [value]]... - the emulated CyberGlove as a program; --help lists what it
 * can be told. Prints the terminal's path, or the link to it, when it is ready. Exits 77 when the
 * system has no pseudo terminal. */
#include "glove_options.h"

#include <stdio.h>
#include <string.h>

enum { EXIT_FAILED = 1, EXIT_USAGE = 2, EXIT_NO_TERMINAL = 77 };

static int exit_status(mrt_result result)
{
    return result >= 0                     ? 0
           : result == MRT_ERR_ARGUMENT    ? EXIT_USAGE
           : result == MRT_ERR_UNSUPPORTED ? EXIT_NO_TERMINAL
                                           : EXIT_FAILED;
}

static const char *link_path;

static void print_path(const char *path)
{
    printf("%s\n", link_path ? link_path : path);
    fflush(stdout);
}

int main(int argc, char **argv)
{
    glove_settings settings = glove_settings_default();
    error err = {""};
    if (argc == 2 && strcmp(argv[1], "--help") == 0) {
        printf("usage: glove_emulator [--option [value]]...\n"
               "A CyberGlove on a pseudo terminal, whose path is printed.\n");
        glove_options_print();
        return 0;
    }
    mrt_result result = glove_options_read((const char *const *)argv + 1, &settings, &err);
    link_path = settings.line.link;
    if (result >= 0)
        result = glove_emulator_run(&settings, print_path, &err);
    if (result < 0)
        fprintf(stderr, "glove_emulator: %s\n", err.text);
    return exit_status(result);
}
