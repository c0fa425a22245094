/* The program: finds the command and runs it. */
#include "command.h"

#include "base/isa.h"
#include "base/memory.h"
#include "base/pool.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>

static const command *const commands[] = {&command_stage,     &command_perform, &command_camera,
                                          &command_calibrate, &command_devices, &command_deform,
                                          &command_plugin,    &command_rig,     &command_take,
                                          &command_bench,     &command_paper};
enum { COMMAND_COUNT = sizeof commands / sizeof commands[0] };

static void print_help(FILE *stream)
{
    fputs("marotte " MAROTTE_VERSION ": perform a face with your hands\n\n"
          "  marotte [SHOW.marotte] [OPTIONS]   the stage: a window; the same as marotte stage\n"
          "  marotte COMMAND [OPTIONS]          (marotte COMMAND --help says more)\n\n",
          stream);
    for (int i = 0; i < COMMAND_COUNT; ++i)
        fprintf(stream, "  %-10s %s\n", commands[i]->name, commands[i]->summary);
    fputs("\nExit codes: 0 done, 1 failed, 2 wrong usage.\n", stream);
}

static bool asks_for_help(int argc, char **argv)
{
    for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; ++i)
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0)
            return true;
    return false;
}

/* Everything that was printed has to have arrived somewhere: a full disk is a failure. */
static int flushed(int code)
{
    bool failed = ferror(stdout) != 0;
    failed |= fflush(stdout) != 0;
    if (!failed || code != COMMAND_DONE)
        return code;
    fputs("marotte: the output could not be written\n", stderr);
    return COMMAND_FAILED;
}

static int start(const command *self, int argc, char **argv)
{
    if (!asks_for_help(argc, argv))
        return flushed(self->run(argc, argv));
    if (self->tell_help) {
        self->tell_help(argc, argv);
    } else {
        fputs(self->help, stdout);
        fputs(self->more_help ? self->more_help : "", stdout);
    }
    return flushed(COMMAND_DONE);
}

int main(int argc, char **argv)
{
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN); /* a file over the size limit is a write that fails */
    memory_set_up();
    error err = {""};
    if (isa_check(&err) < 0 || pool_check(&err) < 0) {
        fprintf(stderr, "marotte: %s\n", err.text);
        return COMMAND_USAGE;
    }
    if (argc < 2)
        return start(&command_stage, argc, argv);
    const char *name = argv[1];
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0 || strcmp(name, "help") == 0) {
        print_help(stdout);
        return flushed(COMMAND_DONE);
    }
    if (strcmp(name, "--version") == 0) {
        puts("marotte " MAROTTE_VERSION);
        return flushed(COMMAND_DONE);
    }
    for (int i = 0; i < COMMAND_COUNT; ++i)
        if (strcmp(name, commands[i]->name) == 0)
            return start(commands[i], argc - 1, argv + 1);
    if (stage_is_meant(name))
        return start(&command_stage, argc, argv);
    fprintf(stderr, "marotte: there is no command \"%s\" (marotte --help)\n", name);
    return COMMAND_USAGE;
}
