/* marotte-plugincheck FILE CASE TYPE SEED INPUT OUTPUT: runs one case of `marotte plugin check`, in
 * a separate process because the plugin may crash it. Writes its findings to descriptor 3 (wire.h);
 * not for people. INPUT and OUTPUT: addresses, "-" for none. */
#include "base/text.h"
#include "check/child/cases.h"
#include "check/child/tell.h"
#include "check/child/trap.h"
#include "check/wire.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct case_entry {
    const char *name;
    void (*run)(const examination *e);
} case_entry;

static const case_entry cases[] = {
    {CASE_TYPE, cases_type},
    {CASE_DESTROY_NULL, cases_destroy_null},
    {CASE_SMOKE, cases_smoke},
    {CASE_LIFE, cases_life},
    {CASE_FACES, cases_faces},
    {CASE_GROWTH, cases_growth},
    {CASE_WALK, cases_walk},
    {CASE_RESTLESS, cases_restless},
    {CASE_HANDS, cases_hands},
    {CASE_ENGAGE, cases_engage},
    {CASE_DEADLINE, cases_deadline},
    {CASE_REPLAY, cases_replay},
    {CASE_SUM, cases_sum},
    {CASE_STATE, cases_state},
    {CASE_RESUME, cases_resume},
    {CASE_ABSENT, cases_absent},
    {CASE_INPUT, cases_input},
    {CASE_RECORDED, cases_recorded},
    {CASE_STOP, cases_stop},
    {CASE_DEVICES, cases_devices},
    {CASE_OUTPUT, cases_output},
    {CASE_FACE_OUTPUT, cases_face_output},
    {CASE_RIG_POSES, cases_rig_poses},
};

static const char *address_of(const char *word)
{
    return strcmp(word, "-") == 0 ? NULL : word;
}

/* Checks needed before hot reload. */
static void run_quick(const types *all, uint64_t seed)
{
    cases_tables(all);
    for (uint32_t i = 0; i < all->count; ++i) {
        const examination e = {.type = all->type[i], .seed = seed, .divisor = 1};
        cases_type(&e);
        if (!tell_has_failed_any())
            cases_smoke(&e);
    }
}

/* Returns MAROTTE_CHECK_DIVISOR: the tests of marotte divide the number of random frames by it. */
static uint32_t divisor_chosen(void)
{
    enum { DIVISOR_MAX = 100 };
    const char *chosen = getenv("MAROTTE_CHECK_DIVISOR");
    int64_t divisor;
    if (!chosen || !text_int(text_view_of(chosen, strlen(chosen)), &divisor) || divisor < 1)
        return 1;
    return divisor < DIVISOR_MAX ? (uint32_t)divisor : DIVISOR_MAX;
}

static void run(char **words)
{
    types all;
    int64_t index = 0, seed = 0;
    if (!types_load(&all, words[1]))
        return;
    if (strcmp(words[2], CASE_TABLES) == 0) {
        cases_tables(&all);
        return;
    }
    if (!text_int(text_view_of(words[3], strlen(words[3])), &index) || index < 0 ||
        index >= all.count || !text_int(text_view_of(words[4], strlen(words[4])), &seed))
        return;
    if (strcmp(words[2], CASE_QUICK) == 0)
        run_quick(&all, (uint64_t)seed);
    const examination e = {all.type[index], (uint64_t)seed, address_of(words[5]),
                           address_of(words[6]), divisor_chosen()};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i)
        if (strcmp(cases[i].name, words[2]) == 0)
            cases[i].run(&e);
}

int main(int argc, char **argv)
{
    if (argc != 7 || fcntl(WIRE_FD, F_SETFD, FD_CLOEXEC) != 0) {
        fputs("marotte-plugincheck: a part of marotte plugin check, which starts it\n", stderr);
        return 2;
    }
    tell_to(WIRE_FD);
    watch_begin(WATCH_LIMIT_S);
    run(argv);
    watch_end();
    tell_end();
    _exit(0); /* skips threads and exit handlers of the plugin */
}
