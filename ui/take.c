/* marotte take: work on takes. Finds the subcommand, opens its show, says what came of it. */
#include "take.h"

#include "base/cancel.h"
#include "place.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const take_verbs *const groups[] = {&take_file_verbs, &take_edit_verbs, &take_layer_verbs,
                                           &take_audio_verbs, &take_play_verbs};
enum { GROUP_COUNT = sizeof groups / sizeof groups[0], HELP_COLUMN = 36 };

/* ---- help ---- */

static void print_overview(FILE *stream)
{
    fputs(
        "marotte take COMMAND SHOW.marotte [TAKE] [OPTIONS]\n"
        "(marotte take COMMAND --help says more)\n\n"
        "Takes are made by marotte perform --record SHOW, be it from devices or from recordings\n"
        "(--input log:FILE imports one). TAKE is a number, scene/shot/number, or last. Times are\n"
        "seconds on the take's timeline, or time code (01:00:02:12). What was recorded is never\n"
        "changed; every edit can be undone.\n",
        stream);
    for (int g = 0; g < GROUP_COUNT; ++g) {
        fprintf(stream, "\n%s\n", groups[g]->title);
        for (uint32_t i = 0; i < groups[g]->count; ++i) {
            const take_verb *verb = &groups[g]->verb[i];
            char call[160];
            (void)snprintf(call, sizeof call, "%s %s", verb->name, verb->words);
            fprintf(stream, "  %-*s %s\n", HELP_COLUMN, call, verb->summary);
        }
    }
    fputs("\nAll: --json, the facts for machines. Exit codes: 0 done, 1 failed, 2 wrong usage.\n",
          stream);
}

static void print_help(const take_verb *verb)
{
    printf("marotte take %s %s [OPTIONS] [--json]\n\n%c%s.\n%s%s", verb->name, verb->words,
           verb->summary[0] >= 'a' && verb->summary[0] <= 'z' ? verb->summary[0] - 'a' + 'A'
                                                              : verb->summary[0],
           verb->summary + 1, verb->options_text[0] ? "\n" : "", verb->options_text);
}

static bool asks_for_help(int argc, char **argv)
{
    for (int i = 1; i < argc; ++i)
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0)
            return true;
    return false;
}

/* ---- which one ---- */

static bool is_named(const take_verb *verb, int argc, char **argv, int *out_used)
{
    size_t length = strlen(argv[1]);
    *out_used = 1;
    if (strcmp(verb->name, argv[1]) == 0)
        return true;
    if (argc < 3 || strncmp(verb->name, argv[1], length) != 0 || verb->name[length] != ' ')
        return false;
    *out_used = 2;
    return strcmp(verb->name + length + 1, argv[2]) == 0;
}

static const take_verb *find(int argc, char **argv, int *out_used)
{
    for (int g = 0; g < GROUP_COUNT; ++g)
        for (uint32_t i = 0; i < groups[g]->count; ++i)
            if (is_named(&groups[g]->verb[i], argc, argv, out_used))
                return &groups[g]->verb[i];
    return NULL;
}

/* ---- run ---- */

static mrt_result work(take_call *call, error *err)
{
    mrt_result result = MRT_OK;
    cancel_on_signals(call->verb->use == TAKE_RECORDS ? CANCEL_WAITS : CANCEL_A_SECOND, NULL);
    if (call->verb->use != TAKE_OPENS_ITSELF)
        result = take_open_show(call, err);
    return result < 0 ? result : call->verb->run(call, err);
}

static int run_call(take_call *call)
{
    error err = {""};
    const char *named = call->text[TAKE_FACE];
    char *found = named ? place_face(named) : NULL;
    if (found)
        call->text[TAKE_FACE] = found;
    call->told = facts_create(call->text[TAKE_JSON] != NULL);
    mrt_result result =
        call->told ? work(call, &err) : error_set(&err, MRT_ERR_MEMORY, "no memory");
    progress_end(&call->shown);
    show_close(call->show);
    free(found);
    if (result >= 0 || call->is_told)
        facts_finish(call->told);
    else
        facts_abandon(call->told);
    if (result >= 0)
        return COMMAND_DONE;
    fprintf(stderr, "marotte take %s: %s", call->verb->name, err.text);
    if (call->is_usage)
        fprintf(stderr, " (marotte take %s --help)", call->verb->name);
    fputc('\n', stderr);
    return call->is_usage ? COMMAND_USAGE : COMMAND_FAILED;
}

static int run(int argc, char **argv)
{
    take_call call;
    int used;
    bool wants_help = asks_for_help(argc, argv);
    const take_verb *verb = argc > 1 ? find(argc, argv, &used) : NULL;
    if (verb && wants_help) {
        print_help(verb);
        return COMMAND_DONE;
    }
    if (wants_help) {
        print_overview(stdout);
        return COMMAND_DONE;
    }
    if (argc < 2)
        return command_usage(&command_take, "say what to do: list, show, trim, export ...");
    if (!verb && (strcmp(argv[1], "layer") == 0 || strcmp(argv[1], "audio") == 0))
        return command_usage(&command_take, "there is no \"take %s %s\"", argv[1],
                             argc > 2 ? argv[2] : "");
    if (!verb)
        return command_usage(&command_take, "there is no \"take %s\"", argv[1]);
    int code = take_options_read(&call, verb, argc - used, argv + used);
    return code == COMMAND_DONE ? run_call(&call) : code;
}

const command command_take = {
    .name = "take", .summary = "lists, edits, performs anew and exports takes", .run = run};
